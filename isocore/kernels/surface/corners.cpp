// corners.cpp - One pass over the triangles that reach into a window puts every corner into its vertex's slots.
#include "surface/corners.hpp"

#include <algorithm>

namespace isocore {
namespace {

constexpr std::size_t kSmallWindow = 32768;

}  // namespace

template <class Offset>
void Corners<Offset>::look_at(std::size_t begin, std::size_t end) {
    begin_ = begin;
    counts_.assign(end - begin, 0);
    slots_.resize(end - begin);
    spilled_.clear();
    const auto lowest = static_cast<std::int32_t>(begin), highest = static_cast<std::int32_t>(end - 1);
    for (std::size_t block = 0; block < blocks_.size(); ++block) {
        const VertexRange range = blocks_[block];
        if (range.highest < lowest || range.lowest > highest) continue;
        const std::int32_t* corners = triangles_ + 3 * block * kTrianglesPerBlock;
        const std::int32_t* last = triangles_ + 3 * std::min(triangle_count_, (block + 1) * kTrianglesPerBlock);
        if (range.lowest >= lowest && range.highest <= highest) {
            add_block<true>(corners, last);
        } else {
            add_block<false>(corners, last);
        }
    }
    std::stable_sort(spilled_.begin(), spilled_.end(),
                     [](const Spilled& a, const Spilled& b) { return a.index < b.index; });
}

template <class Offset>
template <bool kAllInside>
void Corners<Offset>::add_block(const std::int32_t* corners, const std::int32_t* last) {
    // Local copies: the compiler must assume that a write into a slot may change a member (aliasing), and would load
    // the members again each time.
    const auto size = static_cast<std::uint32_t>(counts_.size());
    const auto first = static_cast<std::uint32_t>(begin_);
    std::uint8_t* const counts = counts_.data();
    Slots<Offset>* const slots = slots_.data();
    const auto add = [=, this](std::int32_t vertex, std::int32_t from, std::int32_t to) {
        const std::uint32_t index = static_cast<std::uint32_t>(vertex) - first;
        if (!kAllInside && index >= size) return;
        const LinkEdge<Offset> edge{static_cast<Offset>(from), static_cast<Offset>(to)};
        const std::uint8_t slot = counts[index];
        if (slot >= kSlots) return spill({index, edge});
        counts[index] = static_cast<std::uint8_t>(slot + 1);
        slots[index].edges[slot] = edge;
    };
    for (; corners != last; corners += 3) {
        const std::int32_t a = corners[0], b = corners[1], c = corners[2];
        if ((a == b) | (b == c) | (c == a)) continue;
        add(a, b - a, c - a);
        add(b, c - b, a - b);
        add(c, a - c, b - c);
    }
}

// Kept out of the loop above, because it is rare.
template <class Offset>
void Corners<Offset>::spill(const Spilled& corner) {
    counts_[corner.index] = kSlots + 1;
    spilled_.push_back(corner);
}

template <class Offset>
void Corners<Offset>::copy_link(std::size_t vertex, Link& link) const {
    const std::size_t index = vertex - begin_;
    link.clear();
    for (std::size_t i = 0; i < std::min<std::size_t>(counts_[index], kSlots); ++i) {
        link.push_back({slots_[index].edges[i].from, slots_[index].edges[i].to});
    }
    if (counts_[index] <= kSlots) return;
    auto spilled = std::lower_bound(spilled_.begin(), spilled_.end(), index,
                                    [](const Spilled& entry, std::size_t wanted) { return entry.index < wanted; });
    for (; spilled != spilled_.end() && spilled->index == index; ++spilled) {
        link.push_back({spilled->edge.from, spilled->edge.to});
    }
}

std::size_t window_size(const std::vector<VertexRange>& blocks, std::size_t vertex_count, int threads) {
    std::size_t visits = 0;
    for (const VertexRange& block : blocks) {
        visits += static_cast<std::size_t>(block.highest) / kSmallWindow -
                  static_cast<std::size_t>(block.lowest) / kSmallWindow + 1;
    }
    if (visits <= 4 * blocks.size()) return kSmallWindow;
    return vertex_count / static_cast<std::size_t>(std::clamp(threads, 1, 64)) + 1;
}

template class Corners<std::int16_t>;
template class Corners<std::int32_t>;

}  // namespace isocore
