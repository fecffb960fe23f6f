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
// third within each, so that crowds of them cost little more than what is spread out. Tables of equal steps say where
// to begin.
class Lines {
  public:
    Lines(const std::vector<Point>& points, std::size_t axis)
        : next_((axis + 1) % 3), third_((axis + 2) % 3), order_(points.size()), points_(points) {
        if (points.empty()) return;
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
        strips_ = Steps(lowest_.front(), highest_.back(), 4 * lowest_.size());
        strips_.fill(highest_, 0, highest_.size());
        const auto [low, high] = std::minmax_element(places_.begin(), places_.end());
        for (std::size_t begin = 0; begin < order_.size(); begin += strip_) {
            starts_.emplace_back(*low, *high, 2 * strip_);
            starts_.back().fill(places_, begin, std::min(begin + strip_, order_.size()));
        }
    }

    // Calls found(n) for every point whose line meets the box around the corners.
    template <class Found>
    void for_each(const Corner3& corners, const Found& found) const {
        if (order_.empty()) return;
        const auto [low, high] = ends(corners, next_);
        if (low > highest_.back() || high < lowest_.front()) return;
        const auto [third_low, third_high] = ends(corners, third_);
        for (std::size_t strip = strips_.at(low); strip < lowest_.size() && lowest_[strip] <= high; ++strip) {
            if (highest_[strip] < low) continue;
            const std::size_t end = std::min((strip + 1) * strip_, places_.size());
            for (std::size_t at = starts_[strip].at(third_low); at < end && places_[at] <= third_high; ++at) {
                const double place = points_[order_[at]][next_];
                if (places_[at] >= third_low && low <= place && place <= high) found(order_[at]);
            }
        }
    }

  private:
    // Of ascending numbers, one that is not behind the first that reaches a given one: by a table of equal steps.
    class Steps {
      public:
        Steps() = default;
        Steps(double low, double high, std::size_t count)
            : low_(low), scale_(high > low ? static_cast<double>(count) / (high - low) : 0), table_(count + 1) {}

        void fill(const std::vector<double>& numbers, std::size_t begin, std::size_t end) {
            std::size_t at = begin;
            for (std::size_t step = 0; step < table_.size(); ++step) {
                while (at < end && step_of(numbers[at]) < step) ++at;
                table_[step] = static_cast<std::uint32_t>(at);
            }
        }

        std::size_t at(double number) const { return table_[step_of(number)]; }

      private:
        // Never falls where numbers rise, which is all that is asked of it.
        std::size_t step_of(double number) const {
            const double step = (number - low_) * scale_;
            return step > 0 ? static_cast<std::size_t>(std::min(step, static_cast<double>(table_.size() - 1))) : 0;
        }

        double low_ = 0, scale_ = 0;
        std::vector<std::uint32_t> table_;
    };

    static std::pair<double, double> ends(const Corner3& corners, std::size_t axis) {
        const double a = corners[0][axis], b = corners[1][axis], c = corners[2][axis];
        return {std::min(std::min(a, b), c), std::max(std::max(a, b), c)};
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
    Steps strips_;
    std::vector<Steps> starts_;  // of each strip
    const std::vector<Point>& points_;
};

}  // namespace isocore
