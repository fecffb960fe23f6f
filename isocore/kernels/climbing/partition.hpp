// partition.hpp - From blocks to highrices, top down: a box that is simple, a disk and flat enough is one; any other is
// halved along the axis whose halves come off best. (The paper grows them bottom up, by plots and padis.)
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "climbing/cloud.hpp"
#include "climbing/high_rice.hpp"
#include "common/signs.hpp"

namespace isocore::climbing {

// What the error bound needs to know of a block: where its crossings are.
class Judge {
  public:
    Judge(double bound, const std::array<double, 3>& stretch) : max_error(bound), scale(stretch) {}
    virtual ~Judge() = default;
    // Pushes all crossings of the closed block that starts at sample `origin`, in samples from there. Row (j, k) of the
    // block's sign bits is rows[j + stride * k].
    virtual void gather(const Dims& origin, const std::array<int, 3>& cells, const std::uint64_t* rows, int stride, Clouds& clouds) const = 0;

    const double max_error;
    const std::array<double, 3> scale;
};

// A block with samples on both sides; its highrices are the next `boxes` of its bar.
struct VisitedBlock {
    std::uint32_t x, boxes;
};

// A row of blocks along the first axis: the unit of parallel work.
struct BarBoxes {
    std::vector<VisitedBlock> blocks;
    std::vector<HighRice> boxes;
};

// Finds the highrices of the bar (y, z). Without a judge every box is flat. The block size is 1, 2, 4, 8, 16 or 32.
BarBoxes partition_bar(const SignGrid& signs, int block_size, std::size_t y, std::size_t z, const Judge* judge);

}  // namespace isocore::climbing
