#include "climbing/boxes/bars.hpp"

#include <bit>
#include <stdexcept>

namespace isocore::climbing {

Bars lay_out_bars(const SignGrid& signs, int block_size) {
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
std::size_t place_bars(Bars& bars) {
    std::size_t next = 0;
    for (Bar& bar : bars.bars) {
        bar.first_triangle = next;
        next += bar.triangles;
    }
    return next;
}

Facts sum_facts(const Bars& bars) {
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
