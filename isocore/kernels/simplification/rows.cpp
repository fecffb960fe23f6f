#include "simplification/rows.hpp"

#include <algorithm>

#include "common/lanes.hpp"
#include "common/prefetch.hpp"

namespace isocore::simplification {

void Rows::cover(const Cell& low, const Cell& high) {
    low_ = low;
    high_ = high;
    rows_.assign(static_cast<std::size_t>((high[1] - low[1] + 1) * (high[2] - low[2] + 1)), {kUnknown, 0});
    starts_.clear();
    size_ = 0;
}

bool Rows::cover_all(const Cell& low, const Cell& high) const {
    for (std::size_t a = 0; a < 3; ++a) {
        if (low[a] < low_[a] || high[a] > high_[a]) return false;
    }
    return true;
}

// For all triangles in the box, whether they are asked for or not: room that stays empty takes no memory.
void Rows::make_room(const Reference<float>& reference) {
    std::size_t all = 0;
    reference.index().each_run_between(low_, high_,
                                       [&](std::uint32_t first, std::uint32_t end) { all += end - first; });
    if (size_ == 0) numbers_.clear();  // nothing to be kept
    numbers_.resize((all + 2 * kLanes) * kColumns);
}

void Rows::copy(const Reference<float>& reference, std::int32_t j, std::int32_t k, Row& row) {
    const auto cells = reference.index().occupied({low_[0], j, k}, high_[0] - low_[0] + 1);
    row = {cells.bits, starts_.size()};
    const std::uint32_t first = cells.starts[0], end = cells.starts[std::popcount(cells.bits)];
    for (int n = 0; n <= std::popcount(cells.bits); ++n)
        starts_.push_back(static_cast<std::uint32_t>(size_) + cells.starts[n] - first);
    if (numbers_.size() < (size_ + (end - first) + 2 * kLanes) * kColumns) make_room(reference);
    constexpr std::uint32_t kAhead = 6;
    for (std::uint32_t n = first; n < end; ++n, ++size_) {
        const auto triangle = static_cast<std::int32_t>(n);
        const std::int32_t* const corners = reference.corners(triangle);
        if (n + kAhead < end) {
            for (std::size_t c = 0; c < 3; ++c) ISOCORE_PREFETCH(reference.place(corners[3 * kAhead + c]));
        }
        float* const to = numbers_.data() + size_ / kLanes * kLanes * kColumns + size_ % kLanes;
        for (std::size_t c = 0; c < 3; ++c) {
            const float* const at = reference.place(corners[c]);
            for (std::size_t a = 0; a < 3; ++a) to[(3 * c + a) * kLanes] = at[a];
        }
        to[kBorder * kLanes] = reference.may_be_at_border(triangle) ? 1.0f : 0.0f;
    }
}

}  // namespace isocore::simplification
