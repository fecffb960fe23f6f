// lines.hpp - Lines along one axis, and which of them pass through a triangle: exactly, and so that every line passes
// through a closed surface as often one way as the other, whatever edges or vertices it meets (README.md).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "common/predicates.hpp"

namespace isocore {

using Corner3 = std::array<Point, 3>;

// 1 where the line along `axis` through p leaves what the triangle is in front of, -1 where it enters that, 0 where it
// passes by. The line runs beside p by an infinitely small step along the next axis, and by a still smaller one along
// the third.
inline int passage(const Corner3& corners, const Point& p, std::size_t axis) {
    const std::size_t third = (axis + 2) % 3;
    int passed = 0;
    for (std::size_t n = 0; n < 3; ++n) {
        const Point &u = corners[n], &v = corners[(n + 1) % 3];
        const bool up = u[third] <= p[third] && p[third] < v[third];
        const bool down = v[third] <= p[third] && p[third] < u[third];
        if (up) passed += turn(u, v, p, axis) > 0;
        if (down) passed -= turn(u, v, p, axis) < 0;
    }
    return passed;
}

// Points, to be found by their places across an axis: in strips of equally many along the next axis, sorted along the
// third within each, so that crowds of them cost no more than what is spread out.
class Lines {
  public:
    Lines(const std::vector<Point>& points, std::size_t axis)
        : next_((axis + 1) % 3), third_((axis + 2) % 3), order_(points.size()), points_(points) {
        for (std::size_t n = 0; n < order_.size(); ++n) order_[n] = static_cast<std::uint32_t>(n);
        sort_by(next_, 0, order_.size());
        strip_ = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(order_.size()))));
        for (std::size_t begin = 0; begin < order_.size(); begin += strip_) {
            const std::size_t end = std::min(begin + strip_, order_.size());
            lowest_.push_back(points_[order_[begin]][next_]);
            highest_.push_back(points_[order_[end - 1]][next_]);
            sort_by(third_, begin, end);
        }
        for (const std::uint32_t n : order_) places_.push_back(points_[n][third_]);
    }

    // Calls found(n) for every point whose line meets the box around the corners.
    template <class Found>
    void for_each(const Corner3& corners, const Found& found) const {
        const auto [low, high] = ends(corners, next_);
        const auto [third_low, third_high] = ends(corners, third_);
        const auto first = std::lower_bound(highest_.begin(), highest_.end(), low) - highest_.begin();
        for (auto strip = static_cast<std::size_t>(first); strip < lowest_.size() && lowest_[strip] <= high; ++strip) {
            const auto begin = places_.begin() + static_cast<std::ptrdiff_t>(strip * strip_);
            const auto end =
                places_.begin() + static_cast<std::ptrdiff_t>(std::min((strip + 1) * strip_, places_.size()));
            for (auto at = std::lower_bound(begin, end, third_low); at != end && *at <= third_high; ++at) {
                const std::uint32_t n = order_[static_cast<std::size_t>(at - places_.begin())];
                if (low <= points_[n][next_] && points_[n][next_] <= high) found(n);
            }
        }
    }

  private:
    static std::pair<double, double> ends(const Corner3& corners, std::size_t axis) {
        return std::minmax({corners[0][axis], corners[1][axis], corners[2][axis]});
    }

    void sort_by(std::size_t axis, std::size_t begin, std::size_t end) {
        std::sort(order_.begin() + static_cast<std::ptrdiff_t>(begin),
                  order_.begin() + static_cast<std::ptrdiff_t>(end),
                  [&](std::uint32_t a, std::uint32_t b) { return points_[a][axis] < points_[b][axis]; });
    }

    std::size_t next_, third_, strip_ = 1;
    std::vector<std::uint32_t> order_;      // points, strip by strip
    std::vector<double> lowest_, highest_;  // of each strip, along the next axis
    std::vector<double> places_;            // along the third axis, in that order
    const std::vector<Point>& points_;
};

}  // namespace isocore
