// bars.hpp - What is known of the rows of blocks, and what concerns all of them: marks, room for triangles, sums.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <span>
#include <stdexcept>
#include <vector>

#include "climbing/climb.hpp"
#include "climbing/deviation.hpp"
#include "climbing/layout.hpp"
#include "climbing/partition.hpp"
#include "common/signs.hpp"

namespace isocore::climbing {

// What is known of a row of blocks along the first axis.
struct Bar : BarBoxes {
    std::size_t first_triangle = 0, triangles = 0, capacity = 0;  // of the triangle array
    std::size_t ambiguous_faces = 0, ambiguous_cells = 0;
    std::size_t split_again = 0;
    std::vector<std::size_t> broken;  // boxes that break the error bound
    bool stale = true;                // boxes here or next to it have changed since it was measured
    Deviation in_voxels, in_world;
};

struct Bars {
    Dims blocks;
    std::size_t block_size;
    std::vector<Bar> bars;  // [z][y]
    std::size_t triangles_at_most = 0;

    // Calls visit(origin, boxes, rows of single cells) for every visited block of a bar.
    template <class Visit>
    void visit(std::size_t number, const Visit& visit) const {
        const Bar& bar = bars[number];
        std::span<const HighRice> boxes = bar.boxes;
        std::span<const CellRow> cell_rows = bar.cell_rows;
        for (const VisitedBlock block : bar.blocks) {
            visit(Dims{block.x, block_size * (number % blocks[1]), block_size * (number / blocks[1])}, boxes.first(block.boxes),
                  cell_rows.first(block.cell_rows));
            boxes = boxes.subspan(block.boxes);
            cell_rows = cell_rows.subspan(block.cell_rows);
        }
    }
};

inline std::size_t count_highrices(const Bar& bar) {
    std::size_t count = bar.boxes.size();
    for (const CellRow& row : bar.cell_rows) count += static_cast<std::size_t>(std::popcount(row.cells));
    return count;
}

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

// Vertices of a row's edges along each axis.
inline std::array<std::uint32_t, 3> count_vertices(const SignGrid& signs, const Layout& layout, std::size_t j, std::size_t k) {
    std::array<std::uint32_t, 3> counts = count_crossings(signs, j, k);
    std::size_t first = layout.first_crossing(j, k);
    for (std::uint32_t& count : counts) {
        const std::size_t end = first + count;
        count = layout.count(first, end);
        first = end;
    }
    return counts;
}

// How many triangles a bar draws at most: a loop of n vertices gives n - 2, and a vertex lies on at most four boxes,
// two of one bar if it lies on the bar's side, and one on the bar's edge. Never less than it was before, and looked at
// only where bars are stale.
inline void bound_triangles(const SignGrid& signs, const Layout& layout, Bars& bars) {
    const std::size_t size = bars.block_size, last_j = signs.dims[1] - 1, last_k = signs.dims[2] - 1;
    const auto corners_in = [&](std::size_t bar) {
        const std::size_t j0 = size * (bar % bars.blocks[1]), j1 = std::min(j0 + size, last_j);
        const std::size_t k0 = size * (bar / bars.blocks[1]), k1 = std::min(k0 + size, last_k);
        std::size_t corners = 0;
        for (std::size_t k = k0; k <= k1; ++k) {
            for (std::size_t j = j0; j <= j1; ++j) {
                if (layout.vertices_in(j, k) == 0) continue;
                const std::size_t sides_j = j == j0 || j == j1 ? 1 : 2, sides_k = k == k0 || k == k1 ? 1 : 2;
                const auto counts = count_vertices(signs, layout, j, k);
                corners += counts[0] * sides_j * sides_k;
                if (j < j1) corners += counts[1] * 2 * sides_k;
                if (k < k1) corners += counts[2] * 2 * sides_j;
            }
        }
        return corners;
    };
    std::size_t next = 0;
    for (std::size_t bar = 0; bar < bars.bars.size(); ++bar) {
        Bar& here = bars.bars[bar];
        if (here.stale) here.capacity = std::max(here.capacity, corners_in(bar) - 2 * count_highrices(here));
        here.first_triangle = next;
        next += here.capacity;
    }
    bars.triangles_at_most = next;
}

inline Facts sum_facts(const Bars& bars) {
    Facts facts;
    facts.blocks = bars.blocks[0] * bars.blocks[1] * bars.blocks[2];
    for (const Bar& bar : bars.bars) {
        facts.highrices += count_highrices(bar);
        facts.blocks_visited += bar.blocks.size();
        facts.ambiguous_faces += bar.ambiguous_faces;
        facts.ambiguous_cells += bar.ambiguous_cells;
        facts.split_again += bar.split_again;
        add(facts.in_voxels, bar.in_voxels);
        add(facts.in_world, bar.in_world);
    }
    return facts;
}

}  // namespace isocore::climbing
