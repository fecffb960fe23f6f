// Sections 3 to 5 of the paper (dikes, padis, highrices), turned over: from the block down instead of from the dikes up.
#include "climbing/partition.hpp"

#include <array>
#include <cstdint>
#include <limits>
#include <optional>

#include "climbing/block.hpp"
#include "climbing/flatness.hpp"

namespace isocore::climbing {
namespace {

// Scratch room that one thread hands from block to block.
struct Bench {
    const Judge* judge;
    std::optional<Flatness> flat;
    Clouds clouds;

    explicit Bench(const Judge* given) : judge(given) {
        if (judge) flat.emplace(judge->max_error, judge->scale);
    }
};

template <int N>
class Partition {
  public:
    Partition(const Block<N>& block, Bench& bench, std::vector<HighRice>& boxes) : block_(block), bench_(bench), boxes_(boxes) {}

    void climb(const Dims& origin) {
        const Box whole{1, 1, 1};
        Cloud all{};
        if (bench_.judge) {
            std::array<std::uint64_t, (N + 1) * (N + 1)> rows;
            for (int k = 0; k <= N; ++k) {
                for (int j = 0; j <= N; ++j) rows[static_cast<std::size_t>(j + (N + 1) * k)] = block_.samples(j, k);
            }
            bench_.judge->gather(origin, block_.cells, rows.data(), N + 1, bench_.clouds);
            all = bench_.clouds.since(0);
        }
        settle(whole, judge(whole, all), all);
    }

  private:
    using Dikes = Dike<N>;
    using Box = std::array<Label, 3>;
    enum class Verdict : std::uint8_t { nothing, accepted, split };
    // Cells in a box from which on looking further pays; never where a judge has to look at all crossings.
    static constexpr int kWorthALook = 32;

    // around: the crossings of the box, and perhaps others. A box is met on many ways down, so verdicts are kept.
    Verdict judge(const Box& box, const Cloud& around) {
        std::uint8_t& known = verdicts_[(box[2] * (2 * N) + box[1]) * (2 * N) + box[0]];
        if (known == 0) known = static_cast<std::uint8_t>(1 + static_cast<int>(find_verdict(box, around)));
        return static_cast<Verdict>(known - 1);
    }

    Verdict find_verdict(const Box& box, const Cloud& around) {
        for (std::size_t a = 0; a < 3; ++a) {
            if (Dikes::start(box[a]) >= block_.cells[a]) return Verdict::nothing;
        }
        const bool cell = Dikes::is_unit(box[0]) && Dikes::is_unit(box[1]) && Dikes::is_unit(box[2]);
        if (!cell && !block_.simple(box[0], box[1], box[2])) return Verdict::split;
        const unsigned corners = block_.corners(box[0], box[1], box[2]);
        if (kContents[corners] == Content::nothing) return Verdict::nothing;
        if (cell) return Verdict::accepted;
        if (kContents[corners] == Content::other || !block_.graph(box[0], box[1], box[2])) return Verdict::split;
        return !bench_.judge || flat(box, around, corners) ? Verdict::accepted : Verdict::split;
    }

    bool flat(const Box& box, const Cloud& around, unsigned corners) {
        const std::size_t top = bench_.clouds.top();
        const auto [low, high] = ends(box);
        const bool out = (*bench_.flat)(bench_.clouds.within(around, low, high), low, high, corners);
        bench_.clouds.pop(top);
        return out;
    }

    void settle(const Box& box, Verdict verdict, const Cloud& around) {
        if (verdict == Verdict::nothing) return;
        if (verdict == Verdict::accepted) return boxes_.push_back(high_rice(box));
        const std::size_t top = bench_.clouds.top();
        Cloud here{};
        if (bench_.judge) {
            const auto [low, high] = ends(box);
            here = bench_.clouds.within(around, low, high);
        }
        const std::size_t axis = best_axis(box, here);
        for (const Box& half : halves(box, axis)) settle(half, judge(half, here), here);
        bench_.clouds.pop(top);
    }

    static std::array<Box, 2> halves(const Box& box, std::size_t axis) {
        std::array<Box, 2> out{box, box};
        out[0][axis] = 2 * box[axis];
        out[1][axis] = 2 * box[axis] + 1;
        return out;
    }

    // The axis whose halves come off best, looking one halving further where they must be split again; the longest of
    // several.
    std::size_t best_axis(const Box& box, const Cloud& around) {
        std::size_t best = 0;
        int least = std::numeric_limits<int>::max();
        const bool look_further = !bench_.judge && Dikes::length(box[0]) * Dikes::length(box[1]) * Dikes::length(box[2]) >= kWorthALook;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (Dikes::is_unit(box[axis])) continue;
            int cost = 0;
            for (const Box& half : halves(box, axis)) {
                const Verdict verdict = judge(half, around);
                cost += verdict == Verdict::split && look_further ? cost_of_halves(half, around) : price(verdict);
            }
            cost = 64 * cost - Dikes::length(box[axis]);
            if (cost < least) {
                least = cost;
                best = axis;
            }
        }
        return best;
    }

    int cost_of_halves(const Box& box, const Cloud& around) {
        int least = std::numeric_limits<int>::max();
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (Dikes::is_unit(box[axis])) continue;
            int cost = 0;
            for (const Box& half : halves(box, axis)) cost += price(judge(half, around));
            least = std::min(least, cost);
        }
        return least;
    }

    // In half boxes; a box that must be split yields more than two.
    static int price(Verdict verdict) { return verdict == Verdict::nothing ? 0 : verdict == Verdict::accepted ? 2 : 5; }

    std::array<std::array<float, 3>, 2> ends(const Box& box) const {
        std::array<std::array<float, 3>, 2> out;
        for (std::size_t a = 0; a < 3; ++a) {
            out[0][a] = static_cast<float>(Dikes::start(box[a]));
            out[1][a] = static_cast<float>(std::min(Dikes::end(box[a]), block_.cells[a]));
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

    const Block<N>& block_;
    Bench& bench_;
    std::vector<HighRice>& boxes_;
    std::array<std::uint8_t, 8 * N * N * N> verdicts_{};  // by labels; 0 where not asked yet
};

template <int N>
BarBoxes partition_bar(const SignGrid& signs, std::size_t y, std::size_t z, const Judge* judge) {
    Block<N> block;
    Bench bench(judge);
    BarBoxes out;
    for (std::size_t x = 0; x + 1 < signs.dims[0]; x += N) {
        const Dims origin{x, N * y, N * z};
        if (!block.load(signs, origin)) continue;
        block.survey();
        const std::size_t before = out.boxes.size();
        Partition<N>(block, bench, out.boxes).climb(origin);
        out.blocks.push_back({static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(out.boxes.size() - before)});
    }
    out.boxes.shrink_to_fit();
    return out;
}

}  // namespace

BarBoxes partition_bar(const SignGrid& signs, int block_size, std::size_t y, std::size_t z, const Judge* judge) {
    switch (block_size) {
        case 1: return partition_bar<1>(signs, y, z, judge);
        case 2: return partition_bar<2>(signs, y, z, judge);
        case 4: return partition_bar<4>(signs, y, z, judge);
        case 8: return partition_bar<8>(signs, y, z, judge);
        case 16: return partition_bar<16>(signs, y, z, judge);
        default: return partition_bar<32>(signs, y, z, judge);
    }
}

}  // namespace isocore::climbing
