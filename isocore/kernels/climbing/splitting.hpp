// splitting.hpp - What happens to the few boxes that turn out to break the error bound: they are halved, their new
// cuts become vertices among those there are, and only the bars around are drawn again.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "climbing/bars.hpp"
#include "climbing/high_rice.hpp"
#include "climbing/rim.hpp"
#include "climbing/site.hpp"
#include "common/array.hpp"

namespace isocore::climbing {

struct LateBox {
    Dims origin;
    HighRice box;
};

// The eight corner signs of a box of the block at `origin`.
inline unsigned corners_of(const SignGrid& signs, const Dims& origin, const HighRice& box) {
    unsigned out = 0;
    for (unsigned c = 0; c < 8; ++c) {
        const auto at = [&](std::size_t a) { return origin[a] + (c >> a & 1 ? box.high[a] : box.low[a]); };
        out |= static_cast<unsigned>(signs.at(at(0), at(1), at(2))) << c;
    }
    return out;
}

// Cuts a box that holds a disk down to boxes that do: its parts are as simple, but their corners need not show it.
inline void halve(const SignGrid& signs, const Dims& origin, const HighRice& box, std::vector<HighRice>& out) {
    std::size_t axis = 0;
    for (std::size_t a = 1; a < 3; ++a) {
        if (box.length(a) > box.length(axis)) axis = a;
    }
    HighRice below = box, above = box;
    below.high[axis] = above.low[axis] = static_cast<std::uint8_t>((box.low[axis] + box.high[axis]) / 2);
    for (const HighRice& half : {below, above}) {
        const Content content = kContents[corners_of(signs, origin, half)];
        if (content == Content::nothing) continue;
        if (content == Content::disk || half.is_cell()) out.push_back(half);
        else halve(signs, origin, half, out);
    }
}

inline void split_bar(const SignGrid& signs, const Bars& bars, std::size_t number, Bar& bar, std::vector<LateBox>& late) {
    std::vector<StoredRice> boxes;
    std::vector<CellRow> cell_rows;
    auto broken = bar.broken.begin();
    std::size_t block = 0, box = 0;
    bars.visit(number, [&](const Dims& origin, std::span<const StoredRice> old_boxes, std::span<const CellRow> old_rows) {
        const std::size_t boxes_before = boxes.size(), rows_before = cell_rows.size();
        cell_rows.insert(cell_rows.end(), old_rows.begin(), old_rows.end());
        for (const StoredRice& old : old_boxes) {
            if (broken == bar.broken.end() || *broken != box++) {
                boxes.push_back(old);
                continue;
            }
            ++broken;
            std::vector<HighRice> parts;
            halve(signs, origin, old.box(), parts);
            for (const HighRice& part : parts) {
                late.push_back({origin, part});
                const auto [i, j, k] = part.low;
                if (part.is_cell()) cell_rows.emplace_back(j, k, i / CellRow::kHalf, 1u << i % CellRow::kHalf);
                else boxes.emplace_back(part);
            }
        }
        bar.blocks[block].boxes = static_cast<std::uint32_t>(boxes.size() - boxes_before);
        bar.blocks[block++].cell_rows = static_cast<std::uint32_t>(cell_rows.size() - rows_before);
    });
    bar.boxes = std::move(boxes);
    bar.cell_rows = std::move(cell_rows);
    bar.split_again += bar.broken.size();
    bar.broken.clear();
}

// Halves the boxes that broke the bound, and returns their parts; the bars that these touch are stale then.
inline std::vector<LateBox> split_broken(const SignGrid& signs, Bars& bars) {
    std::vector<LateBox> late;
    for (std::size_t n = 0; n < bars.bars.size(); ++n) {
        if (!bars.bars[n].broken.empty()) split_bar(signs, bars, n, bars.bars[n], late);
    }
    for (const auto& [origin, box] : late) {
        // A sample between two bars lies on both.
        const auto touched = [&](std::size_t a) {
            const std::size_t low = origin[a] + box.low[a], high = origin[a] + box.high[a];
            return std::array{(low - std::min<std::size_t>(low, 1)) / bars.block_size, std::min(high / bars.block_size, bars.blocks[a] - 1)};
        };
        const auto y = touched(1), z = touched(2);
        for (std::size_t k = z[0]; k <= z[1]; ++k) {
            for (std::size_t j = y[0]; j <= y[1]; ++j) bars.bars[j + bars.blocks[1] * k].stale = true;
        }
    }
    return late;
}

// A crossing that a late box makes a vertex of: its number, its grid edge, and that vertex's number.
struct LateVertex {
    std::size_t crossing;
    int axis;
    Dims at;
    std::size_t vertex = 0;
};

// Keeps the crossings on the edges of late boxes; returns those that were not kept before, in the order of their numbers.
inline std::vector<LateVertex> keep_late(const SignGrid& signs, const std::vector<LateBox>& late, int block_size, Layout& layout) {
    std::vector<LateVertex> out;
    const auto site = std::make_unique<Site>(block_size);
    for (const auto& [origin, box] : late) {
        site->begin(signs, layout, origin[1], origin[2]);
        for (std::size_t x = 0; x <= origin[0]; x += static_cast<std::size_t>(block_size)) site->load(x);
        keep_edges(*site, box, layout, [&](std::size_t crossing, int axis, const Place& at) {
            LateVertex& vertex = out.emplace_back(LateVertex{crossing, axis, origin});
            for (std::size_t a = 0; a < 3; ++a) vertex.at[a] += static_cast<std::size_t>(at[a]);
        });
    }
    std::sort(out.begin(), out.end(), [](const LateVertex& a, const LateVertex& b) { return a.crossing < b.crossing; });
    return out;
}

// Makes room for late vertices, which know their numbers, among those there are.
template <class Coordinate>
void make_room(const std::vector<LateVertex>& late, Array<Coordinate>& vertices) {
    auto end = static_cast<std::ptrdiff_t>(vertices.size());
    vertices.resize(vertices.size() + 3 * late.size());
    auto moved = static_cast<std::ptrdiff_t>(3 * late.size());
    for (std::size_t n = late.size(); n-- > 0; moved -= 3) {
        const auto from = static_cast<std::ptrdiff_t>(3 * (late[n].vertex - n));
        std::move_backward(vertices.begin() + from, vertices.begin() + end, vertices.begin() + end + moved);
        end = from;
    }
}

// Turns the numbers that vertices had before into those that they have among the late ones.
inline void renumber(const std::vector<LateVertex>& late, std::span<std::int32_t> vertices) {
    std::vector<std::int32_t> first_moved;
    for (const LateVertex& vertex : late) first_moved.push_back(static_cast<std::int32_t>(vertex.vertex - first_moved.size()));
    for (std::int32_t& vertex : vertices) {
        vertex += static_cast<std::int32_t>(std::upper_bound(first_moved.begin(), first_moved.end(), vertex) - first_moved.begin());
    }
}

// What was drawn anew, by bar.
using Redrawn = std::vector<std::optional<std::vector<std::int32_t>>>;

// Moves the triangles of all bars from where they were `before` to where `bars` wants them now, and puts in what was redrawn.
inline void move_triangles(const std::vector<std::size_t>& before, const Redrawn& redrawn, const Bars& bars, Array<std::int32_t>& triangles) {
    const auto at = [&](std::size_t triangle) { return triangles.begin() + static_cast<std::ptrdiff_t>(3 * triangle); };
    const std::size_t count = bars.bars.size();
    for (std::size_t n = 0; n < count; ++n) {  // from the first on, so that nothing that is yet to move is overwritten
        const Bar& bar = bars.bars[n];
        if (!redrawn[n] && bar.first_triangle < before[n]) std::copy(at(before[n]), at(before[n] + bar.triangles), at(bar.first_triangle));
    }
    for (std::size_t n = count; n-- > 0;) {  // from the last on, for the same reason
        const Bar& bar = bars.bars[n];
        if (!redrawn[n] && bar.first_triangle > before[n]) {
            std::copy_backward(at(before[n]), at(before[n] + bar.triangles), at(bar.first_triangle + bar.triangles));
        }
    }
    for (std::size_t n = 0; n < count; ++n) {
        if (redrawn[n]) std::copy(redrawn[n]->begin(), redrawn[n]->end(), at(bars.bars[n].first_triangle));
    }
}

}  // namespace isocore::climbing
