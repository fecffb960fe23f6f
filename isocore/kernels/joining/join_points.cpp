// join_points.cpp - Open addressing. A slot holds a point and its hash, so that a look at the point itself, which lies
// elsewhere in memory, is seldom in vain. Slots are asked for some points ahead.
#include "joining/join_points.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "common/large_pages.hpp"
#include "common/prefetch.hpp"

namespace isocore {
namespace {

constexpr std::int32_t kNone = -1;
// Where hardly any of so many points coincide with others, none of the rest may, and the table need not grow in steps.
constexpr std::size_t kSample = std::size_t{1} << 15;

using Place = std::array<double, 3>;

// Equal places have equal hashes: adding 0.0 turns -0.0 into 0.0. The low bits of coordinates are often zeros, so the
// high ones are folded down before they are multiplied.
std::uint32_t hash(const Place& place) {
    constexpr std::array<std::uint64_t, 3> kFactors{0x9e3779b97f4a7c15u, 0xd6e8feb86659fd93u, 0xbf58476d1ce4e5b9u};
    std::uint64_t sum = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto bits = std::bit_cast<std::uint64_t>(place[axis] + 0.0);
        sum += (bits ^ bits >> 31) * kFactors[axis];
    }
    sum ^= sum >> 32;
    sum *= 0x94d049bb133111ebu;
    return static_cast<std::uint32_t>(sum >> 32);
}

// The points entered so far by a place: their own coordinates, or the grid cell they lie in. It grows with what is
// entered: where most points coincide with others, it stays in the cache.
class Table {
  public:
    explicit Table(std::size_t count) { make_room(count); }

    // For as many points in all.
    void make_room(std::size_t count) {
        const std::size_t size = std::bit_ceil(2 * count + 2);
        if (size <= slots_.size()) return;
        auto old = large_array<Slot>(size);
        std::ranges::fill(old, Slot{0, kNone});
        old.swap(slots_);
        for (const Slot& slot : old) {
            if (slot.point != kNone) slots_[find(slot.hash, [](std::int32_t) { return false; })] = slot;
        }
    }

    void prefetch(std::uint32_t hash) const { ISOCORE_PREFETCH(&slots_[hash & (slots_.size() - 1)]); }

    // The point whose place is the same, which is this one now where there was none.
    template <class Same>
    std::int32_t find_or_enter(std::uint32_t hash, std::int32_t point, const Same& same) {
        Slot& slot = slots_[find(hash, same)];
        if (slot.point != kNone) return slot.point;
        slot = {hash, point};
        if (2 * ++entered_ > slots_.size()) make_room(slots_.size());
        return point;
    }

    template <class Same>
    std::int32_t found(std::uint32_t hash, const Same& same) const {
        return slots_[find(hash, same)].point;
    }

  private:
    struct Slot {
        std::uint32_t hash;
        std::int32_t point;
    };

    // The slot of the same place, or the empty one where it belongs.
    template <class Same>
    std::size_t find(std::uint32_t hash, const Same& same) const {
        std::size_t slot = hash & (slots_.size() - 1);
        while (slots_[slot].point != kNone && !(slots_[slot].hash == hash && same(slots_[slot].point)))
            slot = (slot + 1) & (slots_.size() - 1);
        return slot;
    }

    Array<Slot> slots_;
    std::size_t entered_ = 0;
};

Place place_of(const double* points, std::size_t point) {
    return {points[3 * point], points[3 * point + 1], points[3 * point + 2]};
}

// Numbers the points in their order: each that is joined with none before it gets the next number.
class Numbering {
  public:
    explicit Numbering(std::size_t count) { result_.number.resize(count); }

    void add(std::size_t point, std::int32_t with) {
        if (static_cast<std::size_t>(with) == point) result_.first.push_back(with);
        result_.number[point] = static_cast<std::size_t>(with) == point
                                    ? static_cast<std::int32_t>(result_.first.size() - 1)
                                    : result_.number[static_cast<std::size_t>(with)];
    }

    std::size_t left() const { return result_.first.size(); }
    JoinedPoints take() { return std::move(result_); }

  private:
    JoinedPoints result_;
};

JoinedPoints join_equal(const double* points, std::size_t count) {
    constexpr std::size_t kAtOnce = 64;
    Numbering numbering(count);
    Table table(std::min(count, kSample));
    std::array<std::uint32_t, kAtOnce> hashes;
    for (std::size_t first = 0; first < count; first += kAtOnce) {
        if (first == kSample && numbering.left() > kSample / 8 * 7) table.make_room(count);
        const std::size_t some = std::min(kAtOnce, count - first);
        for (std::size_t n = 0; n < some; ++n) {
            hashes[n] = hash(place_of(points, first + n));
            table.prefetch(hashes[n]);
        }
        for (std::size_t n = 0; n < some; ++n) {
            const std::size_t point = first + n;
            const Place place = place_of(points, point);
            numbering.add(point,
                          table.find_or_enter(hashes[n], static_cast<std::int32_t>(point), [&](std::int32_t other) {
                              return place_of(points, static_cast<std::size_t>(other)) == place;
                          }));
        }
    }
    return numbering.take();
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
    for (std::size_t n = 0; distance > 0 && n < 3 * count; ++n) farthest = std::max(farthest, std::abs(points[n]));
    // Where the distance is below the coordinates' own steps only equal points lie within it.
    if (!(distance > 0x1p-52 * farthest)) return join_equal(points, count);
    Near near(points, count, distance);
    Numbering numbering(count);
    for (std::size_t point = 0; point < count; ++point) numbering.add(point, near.join(point));
    return numbering.take();
}

}  // namespace isocore
