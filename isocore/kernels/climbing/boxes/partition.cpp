// Sections 3 to 5 of the paper (dikes, padis, highrices), turned over: from the block down instead of from the dikes
// up.
#include "climbing/boxes/partition.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <memory>
#include <utility>

#include "climbing/boxes/bar_shadow.hpp"
#include "climbing/boxes/block.hpp"
#include "climbing/boxes/flatness.hpp"
#include "climbing/boxes/survey.hpp"
#include "climbing/crossings/cloud.hpp"
#include "climbing/crossings/ligns.hpp"
#include "climbing/crossings/rice_edges.hpp"
#include "climbing/crossings/rim.hpp"
#include "common/parallel.hpp"
#include "tables/rims.hpp"

namespace isocore::climbing {
namespace {

template <int N>
class Partition {
  public:
    Partition(const SignGrid& signs, Layout& layout, const Gatherer* gatherer)
        : signs_(signs),
          layout_(layout),
          gatherer_(gatherer),
          flat_(gatherer ? gatherer->max_error : 0),
          site_(N),
          ligns_(N + 1),
          clouds_(N) {}

    // Adds a block to its bar. A bar's blocks come in their order; those whose samples lie on one side are left out.
    void climb(const Dims& origin, BarBoxes& bar) {
        block_.load(signs_, origin);
        measure_dikes();
        survey_.take(block_, !gatherer_);
        if (bar.blocks++ == 0) site_.begin(signs_, layout_, origin[1], origin[2]);
        site_.load(origin[0]);
        edges_.clear();
        boxes_.clear();
        cells_ = {};
        if (gatherer_) {
            for (auto* table : {&asked_, &passed_}) *table = {};
            gather();
        }
        const int found = price(kWhole, crossings_);
        bar.halvings.add_block(fate(found));
        settle(kWhole, found, crossings_, bar.halvings);
        for (const HighRice& box : boxes_) edges_.add(box);
        bar.highrices += boxes_.size();
        for (int n = 0; n < N * N; ++n) {
            const std::uint32_t cells = cells_[static_cast<std::size_t>(n)];
            if (cells == 0) continue;
            edges_.add_cells(n % N, n / N, cells);
            bar.highrices += static_cast<std::size_t>(std::popcount(cells));
        }
        edges_.keep(site_, layout_);
    }

  private:
    using Dikes = Dike<N>;
    using Word = typename DikeBits<N>::Word;
    using Box = std::array<Label, 3>;
    static constexpr Box kWhole{1, 1, 1};
    using Table = std::array<std::array<Word, 2 * N>, 2 * N>;  // by labels: [y][z], bit of x
    // Cells in a box from which on looking further pays; never where a judge has to look at all crossings.
    static constexpr int kWorthALook = 32;
    static constexpr std::size_t kWorthFiltering = 16;  // crossings around a box

    static constexpr int kAccepted = Survey<N>::kAccepted, kSplit = Survey<N>::kSplit;

    void gather() {
        std::size_t crossings = 0;
        for (const Edge& start : site_.crossed_rows())
            crossings +=
                static_cast<std::size_t>(std::popcount(site_.row(start.at(1), start.at(2)).crossed[start.axis()]));
        clouds_.begin(crossings);
        gatherer_->gather(site_, clouds_, ligns_);
        crossings_ = clouds_.finish();
    }

    // around: the crossings of the box, and perhaps others.
    int price(const Box& box, const Cloud& around) {
        const int price = survey_price(box);
        return price == kAccepted && gatherer_ ? judged_price(box, around) : price;
    }

    // Of a box that may be a highrice otherwise.
    int judged_price(const Box& box, const Cloud& around) {
        if (is_cell(box)) return kAccepted;
        // A box is met on many ways down, so what is found out is kept.
        const auto [x, y, z] = box;
        const Word bit = Word{1} << DikeBits<N>::bit(x);
        if (!(asked_[y][z] & bit)) {
            asked_[y][z] |= bit;
            if (is_flat(box, around)) passed_[y][z] |= bit;
        }
        return passed_[y][z] & bit ? kAccepted : kSplit;
    }

    int survey_price(const Box& box) const { return survey_.price(box[1], box[2], DikeBits<N>::bit(box[0])); }

    // The prices of the halves along each axis; of the box itself twice where it is one cell thick.
    using Prices = std::array<std::array<int, 2>, 3>;
    Prices survey_halves(const Box& box) const {
        const auto [x, y, z] = box;
        const auto lower = [](Label label) { return label << !Dikes::is_unit(label); };
        const auto upper = [](Label label) { return label << !Dikes::is_unit(label) | Label{!Dikes::is_unit(label)}; };
        const int bit = DikeBits<N>::bit(x);
        return {{{survey_.price(y, z, DikeBits<N>::bit(lower(x))), survey_.price(y, z, DikeBits<N>::bit(upper(x)))},
                 {survey_.price(lower(y), z, bit), survey_.price(upper(y), z, bit)},
                 {survey_.price(y, lower(z), bit), survey_.price(y, upper(z), bit)}}};
    }

    bool is_flat(const Box& box, const Cloud& around) const {
        const HighRice rice = high_rice(box);
        const unsigned corners = site_.corners(rice);
        const Rim& rim = kRims[corners];
        const EndsByAxis ends = ends_of(rice);
        // Always four or six, which is cheaper than to guess how many.
        Flatness::Ring ring;
        const std::size_t size = rim.length > 4 ? 6 : 4;
        for (std::size_t n = 0; n < size; ++n) ring[n] = along_edge(ends, kSides[rim.edges[n]]);
        std::fill(ring.begin() + size, ring.end(), ring[0]);
        return flat_(around, extent(box), corners, ring);
    }

    // Where the one crossing on an edge of a simple box is along its axis.
    float along_edge(const EndsByAxis& ends, const Side& side) const {
        constexpr std::size_t kSamples = N + 1;
        const std::size_t lign = Ligns::lign(kSamples, side.axis, ends[side.ends[0]], ends[side.ends[1]]);
        const int along = std::countr_zero(ligns_.crossed[lign] & ~std::uint64_t{0} << ends[2u * side.axis]);
        return (static_cast<float>(along) + ligns_.shares[Ligns::edge(kSamples, lign, along)]) *
               gatherer_->scale[side.axis];
    }

    void settle(const Box& box, int found, const Cloud& around, Halvings& halvings) {
        if (found == kSplit) {
            split(box, around, halvings);
        } else if (found == kAccepted) {
            if (is_cell(box))
                cells_[box[1] - N + N * (box[2] - N)] |= std::uint32_t{1} << (box[0] - N);
            else
                boxes_.push_back(high_rice(box));
        }
    }

    void split(const Box& box, const Cloud& around, Halvings& halvings) {
        const std::size_t top = clouds_.top();
        const Cloud here =
            gatherer_ && box != kWhole && around.size > kWorthFiltering ? clouds_.push(around, extent(box)) : around;
        const Choice choice = best_axis(box, here);
        const auto parts = halves(box, choice.axis);
        if (!is_cell(parts[0]))
            halvings.add(axes(box),
                         {static_cast<std::uint8_t>(choice.axis), fate(choice.found[0]), fate(choice.found[1])});
        for (std::size_t n = 0; n < parts.size(); ++n) settle(parts[n], choice.found[n], here, halvings);
        clouds_.pop(top);
    }

    static Fate fate(int found) {
        return found == kSplit ? Fate::halved : found == kAccepted ? Fate::highrice : Fate::nothing;
    }
    static bool is_cell(const Box& box) { return Dikes::is_unit(std::min({box[0], box[1], box[2]})); }
    // Those along which a box can be halved, a bit each.
    static unsigned axes(const Box& box) {
        const auto bit = [&](unsigned axis) { return unsigned{!Dikes::is_unit(box[axis])} << axis; };
        return bit(0) | bit(1) | bit(2);
    }
    static std::array<Box, 2> halves(const Box& box, std::size_t axis) {
        std::array<Box, 2> out{box, box};
        out[0][axis] = 2 * box[axis];
        out[1][axis] = 2 * box[axis] + 1;
        return out;
    }

    // An axis and what becomes of the halves along it.
    struct Choice {
        std::size_t axis;
        std::array<int, 2> found;
    };

    // The axis whose halves come off best, looking one halving further where they must be split again; the longest of
    // several.
    Choice best_axis(const Box& box, const Cloud& around) {
        Prices prices = survey_halves(box);
        std::array<int, 3> ranks;  // least is best
        for (std::size_t axis = 0; axis < 3; ++axis) ranks[axis] = rank(box, axis, prices[axis][0] + prices[axis][1]);
        const auto best = [&] {
            return static_cast<std::size_t>(std::min(std::min(ranks[0], ranks[1]), ranks[2]) & 3);
        };
        if (!gatherer_) {
            if (Dikes::length(box[0]) * Dikes::length(box[1]) * Dikes::length(box[2]) >= kWorthALook) {
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    if (!Dikes::is_unit(box[axis]))
                        ranks[axis] = rank(box, axis, price_further(halves(box, axis), prices[axis]));
                }
            }
            return {best(), prices[best()]};
        }
        // A gatherer can only raise prices, so no half need be brought before it until its axis is the best.
        for (std::array<std::size_t, 3> judged{};;) {
            const std::size_t axis = best();
            if (judged[axis] == 2) return {axis, prices[axis]};
            const std::size_t n = judged[axis]++;
            if (prices[axis][n] != kAccepted) continue;
            prices[axis][n] = judged_price(halves(box, axis)[n], around);
            ranks[axis] = rank(box, axis, prices[axis][0] + prices[axis][1]);
        }
    }

    int price_further(const std::array<Box, 2>& parts, const std::array<int, 2>& prices) const {
        int sum = 0;
        for (std::size_t n = 0; n < parts.size(); ++n) {
            const auto& [x, y, z] = parts[n];
            sum += prices[n] == kSplit ? survey_.price_of_halves(y, z, DikeBits<N>::bit(x)) : prices[n];
        }
        return sum;
    }

    static constexpr int kMoreThanAnyLength = 64, kMoreThanAnyCost = 1 << 10;
    // Of dikes: long ones come first, and those that cannot be halved last.
    static constexpr std::array<int, 2 * N> kRanks = [] {
        std::array<int, 2 * N> ranks{};
        for (Label label = 1; label < 2 * N; ++label)
            ranks[label] =
                4 * ((Dikes::is_unit(label) ? kMoreThanAnyLength * kMoreThanAnyCost : 0) - Dikes::length(label));
        return ranks;
    }();
    static int rank(const Box& box, std::size_t axis, int cost) {
        return kRanks[box[axis]] + 4 * kMoreThanAnyLength * cost + static_cast<int>(axis);
    }

    // Where dikes lie, as far as they do in the volume; the same for most blocks.
    void measure_dikes() {
        for (std::size_t a = 0; a < 3; ++a) {
            if (measured_[a] == block_.cells[a]) continue;
            measured_[a] = block_.cells[a];
            const float scale = gatherer_ ? gatherer_->scale[a] : 1;
            for (Label label = 1; label < 2 * N; ++label) {
                const int low = Dikes::start(label), high = std::min(Dikes::end(label), measured_[a]);
                dikes_[a][label] = {static_cast<std::uint8_t>(low), static_cast<std::uint8_t>(high),
                                    static_cast<float>(low) * scale, static_cast<float>(high) * scale};
            }
        }
    }

    Extent extent(const Box& box) const {
        const Segment &x = dikes_[0][box[0]], &y = dikes_[1][box[1]], &z = dikes_[2][box[2]];
        return {{x.from, y.from, z.from}, {x.to, y.to, z.to}};
    }

    HighRice high_rice(const Box& box) const {
        const Segment &x = dikes_[0][box[0]], &y = dikes_[1][box[1]], &z = dikes_[2][box[2]];
        return {{x.low, y.low, z.low}, {x.high, y.high, z.high}};
    }

    // A dike in samples from the block's origin, and in the unit of the bound.
    struct Segment {
        std::uint8_t low, high;
        float from, to;
    };

    const SignGrid& signs_;
    Layout& layout_;
    const Gatherer* gatherer_;
    Flatness flat_;
    std::array<int, 3> measured_{};  // cells along each axis
    std::array<std::array<Segment, 2 * N>, 3> dikes_;
    Block<N> block_;
    Survey<N> survey_;
    Site site_;
    RiceEdges<N> edges_;
    std::vector<HighRice> boxes_;             // highrices of several cells
    std::array<std::uint32_t, N * N> cells_;  // those of one: [k][j], bit i
    Ligns ligns_;
    Clouds clouds_;
    Cloud crossings_;       // of the whole block
    Table asked_, passed_;  // boxes by labels: judged, and found flat
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
