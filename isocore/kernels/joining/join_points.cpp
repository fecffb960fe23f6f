// join_points.cpp - Open addressing. A slot holds a point and half of its hash, so that a look at the point itself,
// which lies elsewhere in memory, is seldom in vain. Equal points are sorted into buckets by their hash first, so that
// each table stays in the cache.
#include "joining/join_points.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "common/parallel.hpp"

namespace isocore {
namespace {

constexpr std::int32_t kNone = -1;
constexpr std::size_t kPointsPerBucket = 2048, kMostBuckets = 4096, kPointsPerChunk = std::size_t{1} << 18;

using Place = std::array<double, 3>;

// Equal places have equal hashes: adding 0.0 turns -0.0 into 0.0. The low bits of coordinates are often zeros, so the
// high ones are folded down before they are multiplied.
std::uint64_t hash(const Place& place) {
    constexpr std::array<std::uint64_t, 3> kFactors{0x9e3779b97f4a7c15u, 0xd6e8feb86659fd93u, 0xbf58476d1ce4e5b9u};
    std::uint64_t sum = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto bits = std::bit_cast<std::uint64_t>(place[axis] + 0.0);
        sum += (bits ^ bits >> 31) * kFactors[axis];
    }
    sum ^= sum >> 32;
    sum *= 0x94d049bb133111ebu;
    return sum ^ sum >> 29;
}

// The points entered so far by a place: their own coordinates, or the grid cell they lie in.
class Table {
  public:
    explicit Table(std::size_t count) : slots_(std::bit_ceil(2 * count + 2), Slot{0, kNone}) {}

    // The point whose place is the same, or the empty slot where it belongs, which then holds it.
    template <class Same>
    std::int32_t find_or_enter(std::uint64_t hash, std::int32_t point, const Same& same) {
        Slot& slot = slots_[find(hash, same)];
        if (slot.point == kNone) slot = {tag(hash), point};
        return slot.point;
    }

    template <class Same>
    std::int32_t found(std::uint64_t hash, const Same& same) const {
        return slots_[find(hash, same)].point;
    }

  private:
    struct Slot {
        std::uint32_t tag;
        std::int32_t point;
    };

    static std::uint32_t tag(std::uint64_t hash) { return static_cast<std::uint32_t>(hash >> 32); }

    template <class Same>
    std::size_t find(std::uint64_t hash, const Same& same) const {
        std::size_t slot = hash & (slots_.size() - 1);
        while (slots_[slot].point != kNone && !(slots_[slot].tag == tag(hash) && same(slots_[slot].point)))
            slot = (slot + 1) & (slots_.size() - 1);
        return slot;
    }

    std::vector<Slot> slots_;
};

Place place_of(const double* points, std::size_t point) {
    return {points[3 * point], points[3 * point + 1], points[3 * point + 2]};
}

// The points of each bucket, so few that their table stays in the cache; in each they keep their order.
struct Buckets {
    struct Entry {
        std::uint64_t hash;
        std::int32_t point;
    };
    std::size_t count;
    std::vector<std::size_t> start;  // of every bucket, and the end of the last
    Array<Entry> entries;
};

// Chunks of points are sorted apart: a count says where each chunk's points of each bucket go.
Buckets bucketed(const double* points, std::size_t count, int threads) {
    Buckets buckets{std::clamp<std::size_t>(std::bit_ceil(count / kPointsPerBucket + 1), 1, kMostBuckets), {}, {}};
    const std::size_t mask = buckets.count - 1, chunks = count / kPointsPerChunk + 1;
    const auto for_chunk = [&](std::size_t chunk, const auto& work) {
        const std::size_t end = std::min(count, (chunk + 1) * kPointsPerChunk);
        for (std::size_t point = chunk * kPointsPerChunk; point < end; ++point) work(point);
    };
    Array<std::uint64_t> hashes(count);
    std::vector<std::vector<std::uint32_t>> places(chunks);
    parallel_for(threads, chunks, [&](std::size_t chunk) {
        places[chunk].resize(buckets.count);
        for_chunk(chunk, [&](std::size_t point) {
            hashes[point] = hash(place_of(points, point));
            ++places[chunk][hashes[point] & mask];
        });
    });
    std::uint32_t start = 0;
    for (std::size_t bucket = 0; bucket < buckets.count; ++bucket) {
        buckets.start.push_back(start);
        for (auto& of_chunk : places) start += std::exchange(of_chunk[bucket], start);
    }
    buckets.start.push_back(start);
    buckets.entries.resize(count);
    parallel_for(threads, chunks, [&](std::size_t chunk) {
        for_chunk(chunk, [&](std::size_t point) {
            buckets.entries[places[chunk][hashes[point] & mask]++] = {hashes[point], static_cast<std::int32_t>(point)};
        });
    });
    return buckets;
}

// Joins points of equal hashes, which may be different points once in a million meshes.
JoinedPoints join_alike(const double* points, std::size_t count, int threads) {
    JoinedPoints result;
    result.with.resize(count);
    const Buckets buckets = bucketed(points, count, threads);
    std::atomic<std::size_t> joined = 0;
    parallel_for(threads, buckets.count, [&](std::size_t bucket) {
        const std::size_t first = buckets.start[bucket], end = buckets.start[bucket + 1];
        std::vector<Buckets::Entry> slots(std::bit_ceil(2 * (end - first) + 2), {0, kNone});
        std::size_t found = 0;
        for (std::size_t n = first; n < end; ++n) {
            const Buckets::Entry entry = buckets.entries[n];
            std::size_t slot = entry.hash >> 32 & (slots.size() - 1);
            while (slots[slot].point != kNone && slots[slot].hash != entry.hash) slot = (slot + 1) & (slots.size() - 1);
            if (slots[slot].point == kNone) slots[slot] = entry;
            result.with[static_cast<std::size_t>(entry.point)] = slots[slot].point;
            found += slots[slot].point != entry.point;
        }
        joined += found;
    });
    result.joined = joined;
    return result;
}

// The same with a look at every point: slow where these lie apart in memory.
JoinedPoints join_looking(const double* points, std::size_t count) {
    JoinedPoints result;
    result.with.resize(count);
    Table table(count);
    for (std::size_t point = 0; point < count; ++point) {
        const Place place = place_of(points, point);
        const auto id = static_cast<std::int32_t>(point);
        result.with[point] = table.find_or_enter(hash(place), id, [&](std::int32_t other) {
            return place_of(points, static_cast<std::size_t>(other)) == place;
        });
        result.joined += result.with[point] != id;
    }
    return result;
}

JoinedPoints join_equal(const double* points, std::size_t count, int threads) {
    JoinedPoints result = join_alike(points, count, threads);
    if (result.joined == 0) return result;
    for (std::size_t point = 0; point < count; ++point) {
        const auto with = static_cast<std::size_t>(result.with[point]);
        if (with != point && place_of(points, with) != place_of(points, point)) return join_looking(points, count);
    }
    return result;
}

// A grid of cells twice the distance wide: what lies within the distance of a point lies in its cell or one of the
// seven next to the point's octant of it. Only points that stand for themselves are in the grid, so a cell holds few.
class Near {
  public:
    Near(const double* points, std::size_t count, double distance)
        : points_(points), distance_(distance), table_(count), next_(count, kNone) {}

    std::int32_t join(std::size_t point) {
        const Place place = place_of(points_, point);
        Place cell, step;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double at = place[axis] / (2 * distance_);
            cell[axis] = std::floor(at);
            step[axis] = at - cell[axis] < 0.5 ? -1 : 1;
        }
        std::int32_t lowest = kNone;
        for (unsigned octant = 0; octant < 8; ++octant) {
            Place beside = cell;
            for (std::size_t axis = 0; axis < 3; ++axis) beside[axis] += octant >> axis & 1 ? step[axis] : 0.0;
            for (std::int32_t other = first_in(beside); other != kNone;
                 other = next_[static_cast<std::size_t>(other)]) {
                if (within(place, other) && (lowest == kNone || other < lowest)) lowest = other;
            }
        }
        return lowest == kNone ? enter(point, cell) : lowest;
    }

  private:
    bool within(const Place& place, std::int32_t other) const {
        const Place there = place_of(points_, static_cast<std::size_t>(other));
        const double x = place[0] - there[0], y = place[1] - there[1], z = place[2] - there[2];
        return x * x + y * y + z * z <= distance_ * distance_;
    }

    auto same_cell(const Place& cell) const {
        return [this, cell](std::int32_t other) {
            const Place there = place_of(points_, static_cast<std::size_t>(other));
            for (std::size_t axis = 0; axis < 3; ++axis)
                if (std::floor(there[axis] / (2 * distance_)) != cell[axis]) return false;
            return true;
        };
    }

    std::int32_t first_in(const Place& cell) const { return table_.found(hash(cell), same_cell(cell)); }

    // The table holds the first point of a cell; the others hang behind it.
    std::int32_t enter(std::size_t point, const Place& cell) {
        const auto id = static_cast<std::int32_t>(point);
        const std::int32_t head = table_.find_or_enter(hash(cell), id, same_cell(cell));
        if (head != id) {
            next_[point] = next_[static_cast<std::size_t>(head)];
            next_[static_cast<std::size_t>(head)] = id;
        }
        return id;
    }

    const double* points_;
    double distance_;
    Table table_;
    std::vector<std::int32_t> next_;
};

}  // namespace

JoinedPoints join_points(const double* points, std::size_t count, double distance, int threads) {
    if (count > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
        throw std::length_error("a mesh has at most 2^31 - 1 points");
    }
    double farthest = 0;
    for (std::size_t n = 0; n < 3 * count; ++n) farthest = std::max(farthest, std::abs(points[n]));
    // Where the distance is below the coordinates' own steps only equal points lie within it.
    if (!(distance > 0x1p-52 * farthest)) return join_equal(points, count, threads);
    Near near(points, count, distance);
    JoinedPoints result;
    result.with.resize(count);
    for (std::size_t point = 0; point < count; ++point) {
        result.with[point] = near.join(point);
        result.joined += result.with[point] != static_cast<std::int32_t>(point);
    }
    return result;
}

}  // namespace isocore
