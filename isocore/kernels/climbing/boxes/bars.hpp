// bars.hpp - A bar is a row of blocks along the first axis, the unit of parallel work: what is known of each, and what
// concerns all of them.
#pragma once

#include <cstddef>
#include <vector>

#include "climbing/boxes/partition.hpp"
#include "climbing/types.hpp"
#include "samples/signs.hpp"

namespace isocore::climbing {

struct Bar : BarBoxes {
    std::size_t first_triangle = 0, triangles = 0;  // where its triangles are in the triangle array, and how many
    std::size_t ambiguous_faces = 0, ambiguous_cells = 0;
    std::size_t split_again = 0;      // boxes that broke the error bound and were halved late
    std::vector<std::size_t> broken;  // boxes that break it now, by their number in the order of BlockRices::boxes()
    bool stale = true;                // must it be drawn: have boxes in it or in bars beside it changed since it was?
    Deviation in_voxels, in_world;
};

struct Bars {
    Dims blocks;  // per axis
    std::size_t block_size;
    std::vector<Bar> bars;  // [z][y]

    // The first sample of a bar's first block.
    Dims origin(std::size_t number) const {
        return {0, block_size * (number % blocks[1]), block_size * (number / blocks[1])};
    }
};

// The bars of a volume, all empty. Throws std::invalid_argument unless the block size is 1, 2, 4, 8, 16 or 32.
Bars lay_out_bars(const SignGrid& signs, int block_size);

// Puts the triangles of each bar behind those of the one before, and returns how many there are.
std::size_t place_bars(Bars& bars);

Facts sum_facts(const Bars& bars);

}  // namespace isocore::climbing
