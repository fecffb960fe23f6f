// Sections 3 to 5 of the paper (dikes, padis, highrices), turned over: from the block down instead of from the dikes
// up.
#include "climbing/boxes/partition.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <memory>
#include <optional>

#include "climbing/boxes/bar_shadow.hpp"
#include "climbing/boxes/block.hpp"
#include "climbing/boxes/dyadic_box.hpp"
#include "climbing/boxes/flat_boxes.hpp"
#include "climbing/boxes/survey.hpp"
#include "climbing/crossings/rice_edges.hpp"
#include "climbing/crossings/site.hpp"
#include "common/parallel.hpp"

namespace isocore::climbing {
namespace {

// Partitions the blocks of a bar, one after the other. The price of a box is that of survey.hpp; with an error bound it
// is kSplit also for boxes that are not flat enough.
template <int N>
class Partition {
  public:
    // Without a gatherer every box is flat enough.
    Partition(const SignGrid& signs, Layout& layout, const Gatherer* gatherer)
        : signs_(signs), layout_(layout), site_(N) {
        if (!gatherer) return;
        scale_ = gatherer->scale;
        flat_.emplace(*gatherer);
    }

    // Adds a block to its bar. A bar's blocks come in their order; those whose samples lie on one side are left out.
    void climb(const Dims& origin, BarBoxes& bar) {
        block_.load(signs_, origin);
        places_.measure(block_.cells, scale_);
        survey_.take(block_, !flat_);
        if (bar.blocks++ == 0) site_.begin(signs_, layout_, origin[1], origin[2]);
        site_.load(origin[0]);
        boxes_.clear();
        cells_ = {};
        const Cloud crossings = flat_ ? flat_->begin(site_) : Cloud{};
        const int whole = price(Box::whole(), crossings);
        bar.halvings.add_block(fate(whole));
        settle(Box::whole(), whole, crossings, bar.halvings);
        bar.highrices += boxes_.size();
        for (const std::uint32_t cells : cells_) bar.highrices += static_cast<std::size_t>(std::popcount(cells));
        edges_.clear();
        edges_.add(boxes_);
        edges_.add_cells(cells_);
        edges_.keep(site_, layout_);
    }

  private:
    using Dikes = Dike<N>;
    using Box = DyadicBox<N>;
    static constexpr int kAccepted = Survey<N>::kAccepted, kSplit = Survey<N>::kSplit;

    static Fate fate(int price) {
        return price == kSplit ? Fate::halved : price == kAccepted ? Fate::highrice : Fate::nothing;
    }

    // The cloud `around` holds the crossings of the box, and may hold others.
    int price(const Box& box, const Cloud& around) {
        const auto [x, y, z] = box.dikes;
        const int price = survey_.price(y, z, DikeBits<N>::bit(x));
        return price == kAccepted && flat_ ? price_if_flat(box, around) : price;
    }

    // The price of a box that the survey accepts.
    int price_if_flat(const Box& box, const Cloud& around) {
        return box.is_cell() || flat_->passes(site_, places_, box, around) ? kAccepted : kSplit;
    }

    // Does with a box what its price says: notes it as a highrice, or halves it and settles its halves.
    void settle(const Box& box, int price, const Cloud& around, Halvings& halvings) {
        if (price == kSplit) {
            if (flat_)
                flat_->with_cloud_of(places_, box, around, [&](const Cloud& here) { split(box, here, halvings); });
            else
                split(box, around, halvings);
        } else if (price == kAccepted) {
            const auto [x, y, z] = box.dikes;
            if (box.is_cell())
                cells_[y - N + N * (z - N)] |= std::uint32_t{1} << (x - N);
            else
                boxes_.push_back(places_.high_rice(box));
        }
    }

    void split(const Box& box, const Cloud& around, Halvings& halvings) {
        const Choice choice = best_axis(box, around);
        const auto parts = box.halves(choice.axis);
        if (!parts[0].is_cell())
            halvings.add(box.axes(),
                         {static_cast<std::uint8_t>(choice.axis), fate(choice.prices[0]), fate(choice.prices[1])});
        for (std::size_t n = 0; n < parts.size(); ++n) settle(parts[n], choice.prices[n], around, halvings);
    }

    // An axis and the prices of the halves along it.
    struct Choice {
        std::size_t axis;
        std::array<int, 2> prices;
    };

    // The axis whose halves have the least price together, looking one halving further where they must be split; of
    // several axes that along which the box is longest.
    Choice best_axis(const Box& box, const Cloud& around) {
        auto prices = survey_halves(box);
        std::array<int, 3> keys;
        for (std::size_t axis = 0; axis < 3; ++axis) keys[axis] = key(box, axis, prices[axis][0] + prices[axis][1]);
        if (!flat_) {
            if (box.cells() >= kWorthALook) {
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    if (box.can_be_halved(axis))
                        keys[axis] = key(box, axis, price_further(box.halves(axis), prices[axis]));
                }
            }
            return {axis_of_least(keys), prices[axis_of_least(keys)]};
        }
        // The error bound can only raise prices, so no half need be tested until its axis is the best.
        for (std::array<std::size_t, 3> tested{};;) {
            const std::size_t axis = axis_of_least(keys);
            if (tested[axis] == 2) return {axis, prices[axis]};
            const std::size_t n = tested[axis]++;
            if (prices[axis][n] != kAccepted) continue;
            prices[axis][n] = price_if_flat(box.halves(axis)[n], around);
            keys[axis] = key(box, axis, prices[axis][0] + prices[axis][1]);
        }
    }

    // By the survey, the prices of the lower and the upper half along each axis. Along an axis of one cell both are the
    // price of the box itself: so all axes are looked up alike, without a branch.
    std::array<std::array<int, 2>, 3> survey_halves(const Box& box) const {
        const auto [x, y, z] = box.dikes;
        // Label k becomes 2 k or 2 k + 1; that of a unit dike is shifted by 0 and stays.
        const auto lower = [](Label label) { return label << !Dikes::is_unit(label); };
        const auto upper = [](Label label) { return label << !Dikes::is_unit(label) | Label{!Dikes::is_unit(label)}; };
        const int bit = DikeBits<N>::bit(x);
        return {{{survey_.price(y, z, DikeBits<N>::bit(lower(x))), survey_.price(y, z, DikeBits<N>::bit(upper(x)))},
                 {survey_.price(lower(y), z, bit), survey_.price(upper(y), z, bit)},
                 {survey_.price(y, lower(z), bit), survey_.price(y, upper(z), bit)}}};
    }

    // The price of both halves, where a half that must be split has the least price of its own halves.
    int price_further(const std::array<Box, 2>& parts, const std::array<int, 2>& prices) const {
        int sum = 0;
        for (std::size_t n = 0; n < parts.size(); ++n) {
            const auto& [x, y, z] = parts[n].dikes;
            sum += prices[n] == kSplit ? survey_.price_of_halves(y, z, DikeBits<N>::bit(x)) : prices[n];
        }
        return sum;
    }
    // Cells in a box from which on looking further pays; with an error bound it never does, as all those halves would
    // have to be tested.
    static constexpr int kWorthALook = 32;

    // What makes one axis better than another, as one number of which the least is best: that the box can be halved
    // along it, then the price of the halves, then the length of the box, then the axis itself, in the lowest two bits.
    static int key(const Box& box, std::size_t axis, int price) {
        return kDikeKeys[box.dikes[axis]] + 4 * kMoreThanAnyLength * price + static_cast<int>(axis);
    }
    static std::size_t axis_of_least(const std::array<int, 3>& keys) {
        return static_cast<std::size_t>(std::min(std::min(keys[0], keys[1]), keys[2]) & 3);
    }
    static constexpr int kMoreThanAnyLength = 64, kMoreThanAnyPrice = 1 << 10;
    static constexpr std::array<int, 2 * N> kDikeKeys = [] {
        std::array<int, 2 * N> keys{};
        for (Label label = 1; label < 2 * N; ++label)
            keys[label] =
                4 * ((Dikes::is_unit(label) ? kMoreThanAnyLength * kMoreThanAnyPrice : 0) - Dikes::length(label));
        return keys;
    }();

    const SignGrid& signs_;
    Layout& layout_;
    Spot scale_{1, 1, 1};  // from samples to the unit of the error bound
    DikePlaces<N> places_;
    Block<N> block_;
    Survey<N> survey_;
    Site site_;
    RiceEdges<N> edges_;
    std::vector<HighRice> boxes_;             // the block's highrices of several cells
    std::array<std::uint32_t, N * N> cells_;  // those of one: [k][j], bit i
    std::optional<FlatBoxes<N>> flat_;        // last, as it is large and seldom all used
};

template <int N>
std::vector<BarBoxes> partition_bars(const SignGrid& signs, int threads, const Gatherer* gatherer, Layout& layout) {
    const auto blocks = [&](std::size_t axis) { return (signs.dims[axis] - 2) / N + 1; };
    std::vector<BarBoxes> bars(blocks(1) * blocks(2));
    const auto make = [&] { return std::make_unique<Partition<N>>(signs, layout, gatherer); };
    parallel_for(threads, bars.size(), make, [&](const std::unique_ptr<Partition<N>>& partition, std::size_t n) {
        const std::size_t y = N * (n % blocks(1)), z = N * (n / blocks(1));
        const BarShadow shadow(signs, N, y, z);
        BarBoxes& bar = bars[n];
        for (std::size_t x = 0; x + 1 < signs.dims[0]; x += N) {
            const bool is_crossed = shadow.crosses(x, std::min<std::size_t>(N, signs.dims[0] - 1 - x));
            if (is_crossed)
                partition->climb({x, y, z}, bar);
            else
                bar.halvings.add_block(Fate::nothing);
        }
        bar.halvings.shrink_to_fit();
    });
    return bars;
}

}  // namespace

std::vector<BarBoxes> partition_bars(const SignGrid& signs, int block_size, int threads, const Gatherer* gatherer,
                                     Layout& layout) {
    switch (block_size) {
        case 1:
            return partition_bars<1>(signs, threads, gatherer, layout);
        case 2:
            return partition_bars<2>(signs, threads, gatherer, layout);
        case 4:
            return partition_bars<4>(signs, threads, gatherer, layout);
        case 8:
            return partition_bars<8>(signs, threads, gatherer, layout);
        case 16:
            return partition_bars<16>(signs, threads, gatherer, layout);
        default:
            return partition_bars<32>(signs, threads, gatherer, layout);
    }
}

}  // namespace isocore::climbing
