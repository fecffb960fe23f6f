// deviation.hpp - Adds up how far marching cubes' vertices lie from our surface. Each is measured in one box, against
// the triangles of that box alone, so its distance to the whole surface is never larger than what is added here.
#pragma once

#include <array>
#include <cstddef>

#include "climbing/types.hpp"
#include "common/lanes.hpp"

namespace isocore::climbing {

// One partial sum for each lane. They are added together only at the end.
class Tally {
  public:
    // Adds distances and their squares. A lane that is not used has 0 in both.
    void add(const Floats& distances, const Floats& squared) {
        most_ = greatest(most_, distances);
        const auto each = distances.each(), each_squared = squared.each();
        for (std::size_t n = 0; n < each.size(); ++n) {
            sums_[n] += static_cast<double>(each[n]);
            squares_[n] += static_cast<double>(each_squared[n]);
        }
    }

    // The deviation over all distances added, which are in units of length `unit`.
    Deviation sum_up(double unit) const {
        Deviation out;
        out.max = unit * static_cast<double>(most_.greatest_lane());
        for (std::size_t n = 0; n < kLanes; ++n) {
            out.sum += unit * sums_[n];
            out.squares += unit * unit * squares_[n];
        }
        return out;
    }

  private:
    Floats most_ = 0.0f;
    std::array<double, kLanes> sums_{}, squares_{};
};

}  // namespace isocore::climbing
