// splitting.hpp - What happens to the few boxes that turn out to break the error bound: they are halved, their new
// cuts become vertices among those there are, and only the bars around are drawn again.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "climbing/boxes/bars.hpp"
#include "climbing/boxes/halvings.hpp"
#include "climbing/crossings/rim.hpp"
#include "climbing/crossings/site.hpp"
#include "climbing/high_rice.hpp"
#include "common/array.hpp"
#include "tables/rims.hpp"

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

// Writes the halvings of a bar anew: boxes that break the bound are halved until their parts hold disks again. These
// are as simple, but their corners need not show it.
class BrokenBar {
  public:
    BrokenBar(const SignGrid& signs, const Bars& bars, std::size_t number, Bar& bar, std::vector<LateBox>& late)
        : signs_(signs),
          bar_(bar),
          late_(late),
          origin_(bars.origin(number)),
          old_(bar.halvings),
          broken_(bar.broken.begin()) {
        const int size = static_cast<int>(bars.block_size);
        for (; origin_[0] + 1 < signs.dims[0]; origin_[0] += bars.block_size) {
            for (std::size_t a = 0; a < 3; ++a)
                cells_[a] = static_cast<int>(std::min(bars.block_size, signs.dims[a] - 1 - origin_[a]));
            const Fate fate = old_.next_block();
            const Piece block = Piece::block(size);
            if (is_broken(fate)) {
                new_.add_block(Fate::halved);
                halve(block);
            } else {
                new_.add_block(fate);
                if (fate == Fate::halved) copy(block);
            }
        }
        new_.shrink_to_fit();
        bar.halvings = std::move(new_);
        bar.split_again += bar.broken.size();
        bar.broken.clear();
    }

  private:
    // Of a piece that was halved before.
    void copy(const Piece& piece) {
        if (piece.depth() == 1) return;
        const Halving before = old_.next(piece.axes());
        const auto [lower, upper] = piece.halves(before.axis);
        const bool is_lower_broken = is_broken(before.lower), is_upper_broken = is_broken(before.upper);
        new_.add(piece.axes(), {before.axis, is_lower_broken ? Fate::halved : before.lower,
                                is_upper_broken ? Fate::halved : before.upper});
        if (is_lower_broken)
            halve(lower);
        else if (before.lower == Fate::halved)
            copy(lower);
        if (is_upper_broken)
            halve(upper);
        else if (before.upper == Fate::halved)
            copy(upper);
    }

    // Along the longest axis.
    void halve(const Piece& piece) {
        const HighRice box = piece.within(cells_);
        auto axis = static_cast<unsigned>(std::countr_zero(piece.axes()));
        for (unsigned a = 0; a < 3; ++a) {
            if (box.length(a) > box.length(axis)) axis = a;
        }
        const auto [lower, upper] = piece.halves(axis);
        const Fate of_lower = fate(lower, box), of_upper = fate(upper, box);
        if (piece.depth() > 1) new_.add(piece.axes(), {static_cast<std::uint8_t>(axis), of_lower, of_upper});
        settle(lower, of_lower);
        settle(upper, of_upper);
    }

    void settle(const Piece& piece, Fate fate) {
        if (fate == Fate::halved) {
            halve(piece);
        } else if (fate == Fate::highrice) {
            ++bar_.highrices;
            late_.push_back({origin_, piece.within(cells_)});
        }
    }

    // Of a half of a box. At the volume's end the upper half may lie past it; then the lower one is as good as the
    // whole.
    Fate fate(const Piece& half, const HighRice& whole) const {
        const HighRice box = half.within(cells_);
        for (std::size_t a = 0; a < 3; ++a) {
            if (box.length(a) == 0) return Fate::nothing;
        }
        const Content content = kContents[corners_of(signs_, origin_, box)];
        if (content == Content::nothing) return Fate::nothing;
        const bool is_enough = content == Content::disk && box != whole;
        return is_enough || half.depth() == 0 ? Fate::highrice : Fate::halved;
    }

    // Of a piece that fared so, and is the bar's next box if it is a highrice.
    bool is_broken(Fate fate) {
        if (fate != Fate::highrice || broken_ == bar_.broken.end() || box_++ != *broken_) return false;
        ++broken_;
        --bar_.highrices;
        return true;
    }

    const SignGrid& signs_;
    Bar& bar_;
    std::vector<LateBox>& late_;
    Dims origin_;               // of the block
    std::array<int, 3> cells_;  // of the block
    HalvingsReader old_;
    Halvings new_;
    std::vector<std::size_t>::const_iterator broken_;
    std::size_t box_ = 0;  // the next one of several cells
};

// Halves the boxes that broke the bound, and returns their parts; the bars that these touch are stale then.
inline std::vector<LateBox> split_broken(const SignGrid& signs, Bars& bars) {
    std::vector<LateBox> late;
    for (std::size_t n = 0; n < bars.bars.size(); ++n) {
        if (!bars.bars[n].broken.empty()) BrokenBar(signs, bars, n, bars.bars[n], late);
    }
    for (const auto& [origin, box] : late) {
        // A sample between two bars lies on both.
        const auto touched = [&](std::size_t a) {
            const std::size_t low = origin[a] + box.low[a], high = origin[a] + box.high[a];
            return std::array{(low - std::min<std::size_t>(low, 1)) / bars.block_size,
                              std::min(high / bars.block_size, bars.blocks[a] - 1)};
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

// Keeps the crossings on the edges of late boxes; returns those that were not kept before, in the order of their
// numbers.
inline std::vector<LateVertex> keep_late(const SignGrid& signs, const std::vector<LateBox>& late, int block_size,
                                         Layout& layout) {
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
    for (const LateVertex& vertex : late)
        first_moved.push_back(static_cast<std::int32_t>(vertex.vertex - first_moved.size()));
    for (std::int32_t& vertex : vertices) {
        vertex += static_cast<std::int32_t>(std::upper_bound(first_moved.begin(), first_moved.end(), vertex) -
                                            first_moved.begin());
    }
}

// What was drawn anew, by bar.
using Redrawn = std::vector<std::optional<std::vector<std::int32_t>>>;

// Moves the triangles of all bars from where they were `before` to where `bars` wants them now, and puts in what was
// redrawn.
inline void move_triangles(const std::vector<std::size_t>& before, const Redrawn& redrawn, const Bars& bars,
                           Array<std::int32_t>& triangles) {
    const auto at = [&](std::size_t triangle) { return triangles.begin() + static_cast<std::ptrdiff_t>(3 * triangle); };
    const std::size_t count = bars.bars.size();
    for (std::size_t n = 0; n < count; ++n) {  // from the first on, so that nothing that is yet to move is overwritten
        const Bar& bar = bars.bars[n];
        if (!redrawn[n] && bar.first_triangle < before[n])
            std::copy(at(before[n]), at(before[n] + bar.triangles), at(bar.first_triangle));
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
