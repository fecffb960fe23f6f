// Sections 3 to 5 of the paper (dikes, padis, highrices), turned over: from the block down instead of from the dikes up.
#include "climbing/partition.hpp"

#include <array>
#include <cstdint>
#include <stdexcept>

#include "climbing/block.hpp"

namespace isocore::climbing {
namespace {

template <int N>
class Partition {
  public:
    Partition(const Block<N>& block, const std::array<std::size_t, 3>& origin, const Judge* judge, std::vector<HighRice>& boxes)
        : block_(block), judge_(judge), boxes_(boxes) {
        for (std::size_t a = 0; a < 3; ++a) origin_[a] = static_cast<std::int32_t>(origin[a]);
    }

    void climb() {
        const Box whole{1, 1, 1};
        settle(whole, judge(whole));
    }

  private:
    using Dikes = Dike<N>;
    using Box = std::array<Label, 3>;
    enum class Verdict : std::uint8_t { nothing, accepted, split };

    Verdict judge(const Box& box) const {
        for (std::size_t a = 0; a < 3; ++a) {
            if (Dikes::start(box[a]) >= block_.cells[a]) return Verdict::nothing;
        }
        const bool cell = Dikes::is_unit(box[0]) && Dikes::is_unit(box[1]) && Dikes::is_unit(box[2]);
        if (!cell && !block_.simple(box[0], box[1], box[2])) return Verdict::split;
        const Content content = kContents[block_.corners(box[0], box[1], box[2])];
        if (content == Content::nothing) return Verdict::nothing;
        if (cell) return Verdict::accepted;
        if (content == Content::other) return Verdict::split;
        if (!block_.graph(box[0], box[1], box[2])) return Verdict::split;
        return !judge_ || judge_->flat(high_rice(box)) ? Verdict::accepted : Verdict::split;
    }

    void settle(const Box& box, Verdict verdict) {
        if (verdict == Verdict::nothing) return;
        if (verdict == Verdict::accepted) return boxes_.push_back(high_rice(box));
        Box halves[2]{};
        Verdict verdicts[2]{};
        int best = -1;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (Dikes::is_unit(box[axis])) continue;
            Box pair[2] = {box, box};
            pair[0][axis] = 2 * box[axis];
            pair[1][axis] = 2 * box[axis] + 1;
            const Verdict judged[2] = {judge(pair[0]), judge(pair[1])};
            const int settled = (judged[0] != Verdict::split) + (judged[1] != Verdict::split);
            const int score = 64 * settled + Dikes::length(box[axis]);
            if (score > best) {
                best = score;
                for (int n = 0; n < 2; ++n) halves[n] = pair[n], verdicts[n] = judged[n];
            }
        }
        for (int n = 0; n < 2; ++n) settle(halves[n], verdicts[n]);
    }

    HighRice high_rice(const Box& box) const {
        HighRice rice;
        for (std::size_t a = 0; a < 3; ++a) {
            rice.low[a] = origin_[a] + Dikes::start(box[a]);
            rice.high[a] = origin_[a] + std::min(Dikes::end(box[a]), block_.cells[a]);
        }
        return rice;
    }

    const Block<N>& block_;
    std::array<std::int32_t, 3> origin_;
    const Judge* judge_;
    std::vector<HighRice>& boxes_;
};

template <int N>
std::size_t partition_bar(const SignGrid& signs, std::size_t y, std::size_t z, const Judge* judge, std::vector<HighRice>& boxes) {
    Block<N> block;
    std::size_t visited = 0;
    for (std::size_t x = 0; x + 1 < signs.dims[0]; x += N) {
        const std::array<std::size_t, 3> origin{x, N * y, N * z};
        if (!block.load(signs, origin)) continue;
        ++visited;
        block.survey();
        Partition<N>(block, origin, judge, boxes).climb();
    }
    return visited;
}

}  // namespace

std::size_t partition_bar(const SignGrid& signs, int block_size, std::size_t y, std::size_t z, const Judge* judge,
                          std::vector<HighRice>& boxes) {
    switch (block_size) {
        case 1: return partition_bar<1>(signs, y, z, judge, boxes);
        case 2: return partition_bar<2>(signs, y, z, judge, boxes);
        case 4: return partition_bar<4>(signs, y, z, judge, boxes);
        case 8: return partition_bar<8>(signs, y, z, judge, boxes);
        case 16: return partition_bar<16>(signs, y, z, judge, boxes);
        case 32: return partition_bar<32>(signs, y, z, judge, boxes);
        default: throw std::invalid_argument("the block size must be 1, 2, 4, 8, 16 or 32");
    }
}

}  // namespace isocore::climbing
