// partition.hpp - From blocks to highrices, top down: a box that is simple, a disk and flat enough is one; any other is
// halved along the axis whose halves come off best. (The paper grows them bottom up, by plots and padis.)
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "climbing/cloud.hpp"
#include "climbing/halvings.hpp"
#include "climbing/layout.hpp"
#include "climbing/ligns.hpp"
#include "climbing/site.hpp"
#include "common/signs.hpp"

namespace isocore::climbing {

// What the error bound needs to know of a block: where its crossings are. All in units as long as the longest side of a
// voxel, as the squares of very small numbers would be lost.
class Judge {
  public:
    // stretch: the sides of a voxel in the unit of the bound.
    Judge(double bound, const std::array<double, 3>& stretch) {
        const double unit = *std::max_element(stretch.begin(), stretch.end());
        max_error = bound / unit;
        for (std::size_t a = 0; a < 3; ++a) scale[a] = static_cast<float>(stretch[a] / unit);
    }
    virtual ~Judge() = default;
    // Adds all crossings of the closed block.
    virtual void gather(const Site& site, Clouds& clouds, Ligns& ligns) const = 0;

    double max_error;
    Spot scale;  // from samples to that unit
};

// A row of blocks along the first axis: the unit of parallel work.
struct BarBoxes {
    Halvings halvings;
    std::size_t blocks = 0, highrices = 0;  // blocks with samples on both sides, and what they are halved down to
};

// Finds the highrices of all bars, [z][y], and keeps the crossings on their edges. Without a judge every box is flat.
// The block size is 1, 2, 4, 8, 16 or 32.
std::vector<BarBoxes> partition_bars(const SignGrid& signs, int block_size, int threads, const Judge* judge,
                                     Layout& layout);

}  // namespace isocore::climbing
