// partition.hpp - From blocks to highrices, top down: a box that is simple, a disk and flat enough is one; any other is
// halved along the axis whose halves come off best. (The paper grows them bottom up, by plots and padis.)
#pragma once

#include <cstddef>
#include <vector>

#include "climbing/high_rice.hpp"
#include "common/signs.hpp"

namespace isocore::climbing {

// What makes a box too coarse although its topology is right.
class Judge {
  public:
    virtual ~Judge() = default;
    virtual bool flat(const HighRice& box) const = 0;
};

// Appends the highrices of the row of blocks (y, z) along the first axis, block by block; returns how many blocks have
// samples on both sides. Without a judge every box is flat. Throws std::invalid_argument for an impossible block size.
std::size_t partition_bar(const SignGrid& signs, int block_size, std::size_t y, std::size_t z, const Judge* judge,
                          std::vector<HighRice>& boxes);

}  // namespace isocore::climbing
