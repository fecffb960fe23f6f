#include "climbing/error/splitting.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <memory>
#include <utility>

#include "climbing/boxes/halvings.hpp"
#include "climbing/crossings/rim.hpp"
#include "climbing/crossings/site.hpp"
#include "tables/rims.hpp"

namespace isocore::climbing {
namespace {

// The eight corner signs of a box of the block at `origin`.
unsigned corners_of(const SignGrid& signs, const Dims& origin, const HighRice& box) {
    unsigned out = 0;
    for (unsigned c = 0; c < 8; ++c) {
        const auto at = [&](std::size_t a) { return origin[a] + (c >> a & 1 ? box.high[a] : box.low[a]); };
        out |= static_cast<unsigned>(signs.at(at(0), at(1), at(2))) << c;
    }
    return out;
}

// Writes the halvings of one bar anew, block by block, in the preorder in which they were written. Parts of a broken
// box are as simple as the box was; a part is halved further only where its corners do not show that it holds a disk.
class BrokenBar {
  public:
    BrokenBar(const SignGrid& signs, const Bars& bars, std::size_t number, Bar& bar, std::vector<LateHighRice>& late)
        : signs_(signs),
          bar_(bar),
          late_(late),
          origin_(bars.origin(number)),
          old_(bar.halvings),
          broken_(bar.broken.begin()) {
        for (; origin_[0] + 1 < signs.dims[0]; origin_[0] += bars.block_size) write_block(bars);
        new_.shrink_to_fit();
        bar.halvings = std::move(new_);
        bar.split_again += bar.broken.size();
        bar.broken.clear();
    }

  private:
    void write_block(const Bars& bars) {
        for (std::size_t a = 0; a < 3; ++a)
            cells_[a] = static_cast<int>(std::min(bars.block_size, signs_.dims[a] - 1 - origin_[a]));
        const Fate fate = old_.next_block();
        const Piece block = Piece::block(static_cast<int>(bars.block_size));
        if (is_broken(fate)) {
            new_.add_block(Fate::halved);
            halve(block);
        } else {
            new_.add_block(fate);
            if (fate == Fate::halved) copy(block);
        }
    }

    // Copies the halvings of a piece that was halved before, and halves the broken boxes in it. In a piece of two cells
    // (depth 1) there are none, and nothing is written of it.
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

    // Halves a broken box, or a part of one, along its longest axis.
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

    // Goes on with a half whose fate has been written.
    void settle(const Piece& piece, Fate fate) {
        if (fate == Fate::halved) {
            halve(piece);
        } else if (fate == Fate::highrice) {
            ++bar_.highrices;
            late_.push_back({origin_, piece.within(cells_)});
        }
    }

    // What becomes of a half of a broken box. At the volume's end the upper half may lie past the last sample; then the
    // lower half is the whole box again, and has to be halved once more.
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

    // Is a piece of this fate a highrice that is next on the broken list? To be asked once for each piece, in order, as
    // it counts the bar's highrices.
    bool is_broken(Fate fate) {
        if (fate != Fate::highrice || broken_ == bar_.broken.end() || box_++ != *broken_) return false;
        ++broken_;
        --bar_.highrices;
        return true;
    }

    const SignGrid& signs_;
    Bar& bar_;
    std::vector<LateHighRice>& late_;
    Dims origin_;               // the block's first sample
    std::array<int, 3> cells_;  // the block's size
    HalvingsReader old_;
    Halvings new_;
    std::vector<std::size_t>::const_iterator broken_;  // the next broken box
    std::size_t box_ = 0;                              // the number of the bar's next highrice of several cells
};

}  // namespace

std::vector<LateHighRice> split_broken(const SignGrid& signs, Bars& bars) {
    std::vector<LateHighRice> late;
    for (std::size_t n = 0; n < bars.bars.size(); ++n) {
        if (!bars.bars[n].broken.empty()) BrokenBar(signs, bars, n, bars.bars[n], late);
    }
    for (const auto& [origin, box] : late) {
        // The bars along axis a that the box touches: a sample between two bars belongs to both.
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

std::vector<LateVertex> keep_late(const SignGrid& signs, const std::vector<LateHighRice>& late, int block_size,
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

}  // namespace isocore::climbing
