// bars.hpp - What is known of the rows of blocks, and what concerns all of them: marks, places of triangles, sums.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <stdexcept>
#include <vector>

#include "climbing/boxes/partition.hpp"
#include "climbing/types.hpp"
#include "samples/signs.hpp"

namespace isocore::climbing {

// What is known of a row of blocks along the first axis.
struct Bar : BarBoxes {
    std::size_t first_triangle = 0, triangles = 0;  // of the triangle array
    std::size_t ambiguous_faces = 0, ambiguous_cells = 0;
    std::size_t split_again = 0;
    std::vector<std::size_t> broken;  // boxes of several cells that break the error bound, by their order
    bool stale = true;                // boxes here or next to it have changed since it was measured
    Deviation in_voxels, in_world;
};

struct Bars {
    Dims blocks;
    std::size_t block_size;
    std::vector<Bar> bars;  // [z][y]

    // Where a bar starts.
    Dims origin(std::size_t number) const {
        return {0, block_size * (number % blocks[1]), block_size * (number / blocks[1])};
    }
};

inline Bars lay_out_bars(const SignGrid& signs, int block_size) {
    if (block_size < 1 || block_size > 32 || !std::has_single_bit(static_cast<unsigned>(block_size))) {
        throw std::invalid_argument("the block size must be 1, 2, 4, 8, 16 or 32");
    }
    Bars out;
    out.block_size = static_cast<std::size_t>(block_size);
    for (std::size_t a = 0; a < 3; ++a) out.blocks[a] = (signs.dims[a] - 2) / out.block_size + 1;
    out.bars.resize(out.blocks[1] * out.blocks[2]);
    return out;
}

// Puts the triangles of each bar behind those of the one before, and returns how many there are.
inline std::size_t place_bars(Bars& bars) {
    std::size_t next = 0;
    for (Bar& bar : bars.bars) {
        bar.first_triangle = next;
        next += bar.triangles;
    }
    return next;
}

inline Facts sum_facts(const Bars& bars) {
    Facts facts;
    facts.blocks = bars.blocks[0] * bars.blocks[1] * bars.blocks[2];
    for (const Bar& bar : bars.bars) {
        facts.highrices += bar.highrices;
        facts.blocks_visited += bar.blocks;
        facts.ambiguous_faces += bar.ambiguous_faces;
        facts.ambiguous_cells += bar.ambiguous_cells;
        facts.split_again += bar.split_again;
        add(facts.in_voxels, bar.in_voxels);
        add(facts.in_world, bar.in_world);
    }
    return facts;
}

}  // namespace isocore::climbing
