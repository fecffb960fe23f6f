// join_points.cpp - Open addressing in a table twice as long as there are points. A slot holds a point and half of its
// hash, so that a look at the point itself, which lies elsewhere in memory, is seldom in vain; slots are fetched ahead.
#include "joining/join_points.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace isocore {
namespace {

constexpr std::int32_t kNone = -1;
constexpr std::size_t kAhead = 32;

using Place = std::array<double, 3>;

std::uint64_t scrambled(std::uint64_t bits) {
    bits ^= bits >> 32;
    bits *= 0xd6e8feb86659fd93u;
    return bits ^ bits >> 29;
}

// Equal places have equal hashes: adding 0.0 turns -0.0 into 0.0.
std::uint64_t hash(const Place& place) {
    std::uint64_t sum = 0;
    for (const double coordinate : place)
        sum = scrambled(sum + 0x9e3779b97f4a7c15u + std::bit_cast<std::uint64_t>(coordinate + 0.0));
    return sum;
}

// The points entered so far by a place: their own coordinates, or the grid cell they lie in.
class Table {
  public:
    explicit Table(std::size_t count) : slots_(std::bit_ceil(2 * count + 2), Slot{0, kNone}) {}

    void fetch(std::uint64_t hash) const {
#if defined(__GNUC__)
        __builtin_prefetch(&slots_[hash & (slots_.size() - 1)]);
#else
        (void)hash;
#endif
    }

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

JoinedPoints join_equal(const double* points, std::size_t count) {
    JoinedPoints result;
    result.with.resize(count);
    Table table(count);
    std::array<std::uint64_t, kAhead> hashes;
    for (std::size_t first = 0; first < count; first += kAhead) {
        const std::size_t end = std::min(count, first + kAhead);
        for (std::size_t point = first; point < end; ++point) {
            hashes[point - first] = hash(place_of(points, point));
            table.fetch(hashes[point - first]);
        }
        for (std::size_t point = first; point < end; ++point) {
            const Place place = place_of(points, point);
            const auto same = [&](std::int32_t other) {
                return place_of(points, static_cast<std::size_t>(other)) == place;
            };
            const auto id = static_cast<std::int32_t>(point);
            result.with[point] = table.find_or_enter(hashes[point - first], id, same);
            result.joined += result.with[point] != id;
        }
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

JoinedPoints join_points(const double* points, std::size_t count, double distance) {
    if (count > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
        throw std::length_error("a mesh has at most 2^31 - 1 points");
    }
    double farthest = 0;
    for (std::size_t n = 0; n < 3 * count; ++n) farthest = std::max(farthest, std::abs(points[n]));
    // Where the distance is below the coordinates' own steps only equal points lie within it.
    if (!(distance > 0x1p-52 * farthest)) return join_equal(points, count);
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
