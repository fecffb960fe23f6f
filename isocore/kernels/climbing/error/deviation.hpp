// deviation.hpp - How far marching cubes' vertices lie from our surface: each is measured in one box, against the
// triangles of that box. So the true distance is never larger.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "climbing/types.hpp"
#include "common/lanes.hpp"

namespace isocore::climbing {

// Distances that are yet to be added up, lane by lane.
class Tally {
  public:
    using Numbers = Lanes<float>;

    void add(const Numbers& distances, const Numbers& squared) {
        most_ = greatest(most_, distances);
        const auto each = distances.each(), each_squared = squared.each();
        for (std::size_t n = 0; n < each.size(); ++n) {
            sums_[n] += static_cast<double>(each[n]);
            squares_[n] += static_cast<double>(each_squared[n]);
        }
    }

    // Of all that was added, in units that are `unit` long.
    Deviation sum_up(double unit) const {
        Deviation out;
        out.max = unit * static_cast<double>(most_.greatest_lane());
        for (std::size_t n = 0; n < kLanes<float>; ++n) {
            out.sum += unit * sums_[n];
            out.squares += unit * unit * squares_[n];
        }
        return out;
    }

  private:
    Numbers most_ = 0.0f;
    std::array<double, kLanes<float>> sums_{}, squares_{};
};

}  // namespace isocore::climbing
