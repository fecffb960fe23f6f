// Sections 3 to 5 of the paper (dikes, padis, highrices), turned over: from the block down instead of from the dikes up.
#include "climbing/partition.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>

#include "climbing/block.hpp"
#include "climbing/cloud.hpp"
#include "climbing/cuts.hpp"
#include "climbing/flatness.hpp"
#include "climbing/padi.hpp"
#include "climbing/survey.hpp"

namespace isocore::climbing {
namespace {

template <int N>
class Partition {
  public:
    Partition(const SignGrid& signs, Layout& layout, const Judge* judge)
        : signs_(signs), layout_(layout), judge_(judge), flat_(judge ? judge->max_error : 0), site_(N) {}

    // Adds a block to its bar, unless all its samples lie on one side. A bar's blocks come in their order.
    void climb(const Dims& origin, BarBoxes& bar) {
        if (!block_.load(signs_, origin)) return;
        survey_.take(block_);
        if (bar.blocks.empty()) site_.begin(signs_, layout_, origin[1], origin[2]);
        site_.load(origin[0]);
        cuts_.clear();
        cells_ = {};
        if (judge_) {
            for (auto* table : {&asked_, &passed_}) *table = {};
            gather();
        }
        const std::size_t boxes = bar.boxes.size(), rows = bar.cell_rows.size();
        const Box whole{1, 1, 1};
        settle(whole, price(whole, crossings_), crossings_, bar.boxes);
        for (std::size_t n = boxes; n < bar.boxes.size(); ++n) cuts_.add(bar.boxes[n]);
        for (int n = 0; n < N * N; ++n) {
            const std::uint32_t cells = cells_[static_cast<std::size_t>(n)];
            if (cells == 0) continue;
            bar.cell_rows.push_back({static_cast<std::uint8_t>(n % N), static_cast<std::uint8_t>(n / N), cells});
            cuts_.add_cells(n % N, n / N, cells);
        }
        cuts_.keep(site_, layout_);
        bar.blocks.push_back({static_cast<std::uint32_t>(origin[0]), static_cast<std::uint32_t>(bar.boxes.size() - boxes),
                              static_cast<std::uint32_t>(bar.cell_rows.size() - rows)});
    }

  private:
    using Dikes = Dike<N>;
    using Word = typename DikeBits<N>::Word;
    using Box = std::array<Label, 3>;
    using Table = std::array<std::array<Word, 2 * N>, 2 * N>;  // by labels: [y][z], bit of x
    // Cells in a box from which on looking further pays; never where a judge has to look at all crossings.
    static constexpr int kWorthALook = 32;
    static constexpr std::size_t kWorthFiltering = 16;  // crossings around a box
    static constexpr std::size_t kLevels = 3 * Dikes::kDepth + 1;

    // What becomes of a box, as the price of what it yields: in half boxes, and more than two boxes if it is split.
    static constexpr int kNothing = 0, kAccepted = 2, kSplit = 5;

    void gather() {
        site_.lay_columns();
        std::uint32_t count = 0;
        for (int k = 0; k <= site_.cells[2]; ++k) {
            for (int j = 0; j <= site_.cells[1]; ++j) {
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    first_[row_index(j, k)][axis] = count;
                    count += static_cast<std::uint32_t>(std::popcount(site_.row(j, k).crossed[axis]));
                }
            }
        }
        clouds_.reset(count, kLevels);
        judge_->gather(site_, clouds_);
        crossings_ = clouds_.finish();
    }

    // around: the crossings of the box, and perhaps others.
    int price(const Box& box, const Cloud& around) {
        const int price = survey_price(box);
        if (price != kAccepted || !judge_ || is_cell(box)) return price;
        // A box is met on many ways down, so what is found out is kept.
        const auto [x, y, z] = box;
        const Word bit = Word{1} << DikeBits<N>::bit(x);
        if (!(asked_[y][z] & bit)) {
            asked_[y][z] |= bit;
            if (is_flat(box, around)) passed_[y][z] |= bit;
        }
        return passed_[y][z] & bit ? kAccepted : kSplit;
    }

    int survey_price(const Box& box) const {
        const auto [x, y, z] = box;
        return survey_.nothing(x, y, z) ? kNothing : survey_.may_be_highrice(x, y, z) ? kAccepted : kSplit;
    }

    bool is_flat(const Box& box, const Cloud& around) const {
        const HighRice rice = high_rice(box);
        const Rim& rim = kRims[site_.corners(rice)];
        Flatness::Ring ring;
        for (unsigned n = 0; n < rim.length; ++n) {
            const RimEdge edge = box_crossing(site_, rice, rim.edges[n]);
            const auto axis = static_cast<std::size_t>(edge.axis);
            const std::uint64_t before = site_.row(edge.at[1], edge.at[2]).crossed[axis] & ((std::uint64_t{1} << edge.at[0]) - 1);
            ring[n] = crossings_[first_[row_index(edge.at[1], edge.at[2])][axis] + static_cast<std::size_t>(std::popcount(before))];
        }
        return flat_(around, extent(rice), rim, ring);
    }

    void settle(const Box& box, int found, const Cloud& around, std::vector<HighRice>& boxes) {
        if (found == kNothing) return;
        if (found == kAccepted) {
            if (is_cell(box)) cells_[box[1] - N + N * (box[2] - N)] |= std::uint32_t{1} << (box[0] - N);
            else boxes.push_back(high_rice(box));
            return;
        }
        const std::size_t top = clouds_.top();
        Cloud here = around;
        if (judge_ && around.size > kWorthFiltering) here = clouds_.push(around, extent(high_rice(box)));
        for (const Box& half : halves(box, best_axis(box, here))) settle(half, price(half, here), here, boxes);
        clouds_.pop(top);
    }

    static bool is_cell(const Box& box) { return Dikes::is_unit(box[0]) && Dikes::is_unit(box[1]) && Dikes::is_unit(box[2]); }
    static std::array<Box, 2> halves(const Box& box, std::size_t axis) {
        std::array<Box, 2> out{box, box};
        out[0][axis] = 2 * box[axis];
        out[1][axis] = 2 * box[axis] + 1;
        return out;
    }

    static std::array<std::size_t, 3> longest_first(const Box& box) {
        std::array<std::size_t, 3> axes{0, 1, 2};
        const auto put_in_order = [&](std::size_t n, std::size_t m) {
            if (Dikes::length(box[axes[n]]) < Dikes::length(box[axes[m]])) std::swap(axes[n], axes[m]);
        };
        put_in_order(0, 1);
        put_in_order(1, 2);
        put_in_order(0, 1);
        return axes;
    }

    // The axis whose halves come off best, looking one halving further where they must be split again; the longest of
    // several.
    std::size_t best_axis(const Box& box, const Cloud& around) {
        const auto axes = longest_first(box);
        std::size_t best = axes[0];
        int least = std::numeric_limits<int>::max();
        const bool look_further = !judge_ && Dikes::length(box[0]) * Dikes::length(box[1]) * Dikes::length(box[2]) >= kWorthALook;
        for (const std::size_t axis : axes) {
            if (Dikes::is_unit(box[axis])) break;
            const auto parts = halves(box, axis);
            int cost = 0;
            if (look_further) {
                for (const Box& half : parts) {
                    const int found = survey_price(half);
                    cost += found == kSplit ? cost_of_halves(half) : found;
                }
            } else {
                // A judge can only raise prices, so many axes need not be brought before it.
                cost = survey_price(parts[0]) + survey_price(parts[1]);
                for (const Box& half : parts) {
                    if (judge_ && 64 * cost - Dikes::length(box[axis]) < least) cost += price(half, around) - survey_price(half);
                }
            }
            cost = 64 * cost - Dikes::length(box[axis]);
            if (cost < least) {
                least = cost;
                best = axis;
            }
        }
        return best;
    }

    int cost_of_halves(const Box& box) const {
        int least = std::numeric_limits<int>::max();
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (Dikes::is_unit(box[axis])) continue;
            const auto parts = halves(box, axis);
            least = std::min(least, survey_price(parts[0]) + survey_price(parts[1]));
        }
        return least;
    }

    Extent extent(const HighRice& box) const {
        Extent out;
        for (std::size_t a = 0; a < 3; ++a) {
            out.low[a] = static_cast<float>(box.low[a]) * judge_->scale[a];
            out.high[a] = static_cast<float>(box.high[a]) * judge_->scale[a];
        }
        return out;
    }

    HighRice high_rice(const Box& box) const {
        HighRice rice;
        for (std::size_t a = 0; a < 3; ++a) {
            rice.low[a] = static_cast<std::uint8_t>(Dikes::start(box[a]));
            rice.high[a] = static_cast<std::uint8_t>(std::min(Dikes::end(box[a]), block_.cells[a]));
        }
        return rice;
    }

    static std::size_t row_index(int j, int k) { return static_cast<std::size_t>(j + (N + 1) * k); }

    const SignGrid& signs_;
    Layout& layout_;
    const Judge* judge_;
    Flatness flat_;
    Block<N> block_;
    Survey<N> survey_;
    Site site_;
    Cuts<N> cuts_;
    std::array<std::uint32_t, N * N> cells_;  // highrices of one cell: [k][j], bit i
    Clouds clouds_;
    Cloud crossings_;                                                    // of the whole block
    std::array<std::array<std::uint32_t, 3>, (N + 1) * (N + 1)> first_;  // of them, the first along each axis of row (j, k)
    Table asked_, passed_;                                               // boxes by labels: judged, and found flat
};

template <int N>
BarBoxes partition_bar(const SignGrid& signs, std::size_t y, std::size_t z, const Judge* judge, Layout& layout) {
    const auto partition = std::make_unique<Partition<N>>(signs, layout, judge);
    BarBoxes out;
    for (std::size_t x = 0; x + 1 < signs.dims[0]; x += N) partition->climb({x, N * y, N * z}, out);
    out.boxes.shrink_to_fit();
    out.cell_rows.shrink_to_fit();
    return out;
}

}  // namespace

BarBoxes partition_bar(const SignGrid& signs, int block_size, std::size_t y, std::size_t z, const Judge* judge, Layout& layout) {
    switch (block_size) {
        case 1: return partition_bar<1>(signs, y, z, judge, layout);
        case 2: return partition_bar<2>(signs, y, z, judge, layout);
        case 4: return partition_bar<4>(signs, y, z, judge, layout);
        case 8: return partition_bar<8>(signs, y, z, judge, layout);
        case 16: return partition_bar<16>(signs, y, z, judge, layout);
        default: return partition_bar<32>(signs, y, z, judge, layout);
    }
}

}  // namespace isocore::climbing
