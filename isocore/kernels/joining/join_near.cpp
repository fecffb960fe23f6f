#include "joining/join_near.hpp"

#include <cmath>
#include <vector>

#include "joining/table.hpp"

namespace isocore {
namespace {

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

JoinedPoints join_near(const double* points, std::size_t count, double distance) {
    Near near(points, count, distance);
    JoinedPoints result;
    result.number.resize(count);
    for (std::size_t point = 0; point < count; ++point) {
        const auto with = static_cast<std::size_t>(near.join(point));
        if (with == point) {
            result.number[point] = static_cast<std::int32_t>(result.first.size());
            result.first.push_back(static_cast<std::int32_t>(point));
        } else {
            result.number[point] = result.number[with];
        }
    }
    return result;
}

}  // namespace isocore
