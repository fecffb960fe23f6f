// partition.hpp - From blocks to highrices, top down: a box that is simple, a disk and flat enough is one; any other is
// halved along the axis whose halves come off best. (The paper grows them bottom up, by plots and padis.)
#pragma once

#include <cstddef>
#include <vector>

#include "climbing/boxes/halvings.hpp"
#include "climbing/crossings/gatherer.hpp"
#include "climbing/crossings/layout.hpp"
#include "samples/signs.hpp"

namespace isocore::climbing {

// What partition makes of a bar, a row of blocks along the first axis.
struct BarBoxes {
    Halvings halvings;
    std::size_t blocks = 0, highrices = 0;  // blocks with samples on both sides, and what they are halved down to
};

// Finds the highrices of all bars, [z][y], and keeps the crossings on their edges in the layout. Without a gatherer
// there is no error bound, and every box is flat enough. The block size is 1, 2, 4, 8, 16 or 32; the bars are the same
// for any number of threads.
std::vector<BarBoxes> partition_bars(const SignGrid& signs, int block_size, int threads, const Gatherer* gatherer,
                                     Layout& layout);

}  // namespace isocore::climbing
