// corners.cpp - One pass over the triangles that reach into a window puts every corner into its vertex's slots.
#include "surface/corners.hpp"

#include <algorithm>

namespace isocore {
namespace {

constexpr std::size_t kSmallWindow = 16384;

}  // namespace

void Corners::look_at(std::size_t begin, std::size_t end) {
    begin_ = begin;
    counts_.assign(end - begin, 0);
    slots_.resize(end - begin);
    spilled_.clear();
    // Local copies: a write into a slot could otherwise be one into a member.
    const auto size = static_cast<std::uint32_t>(end - begin);
    const auto first = static_cast<std::uint32_t>(begin);
    std::uint32_t* counts = counts_.data();
    Slots* slots = slots_.data();
    const auto add = [=, this](std::int32_t vertex, std::int32_t from, std::int32_t to) {
        const std::uint32_t index = static_cast<std::uint32_t>(vertex) - first;
        if (index >= size) return;
        const std::uint32_t slot = counts[index]++;
        if (slot >= kSlots) return spill({index, {from, to}});
        slots[index].from[slot] = from;
        slots[index].to[slot] = to;
    };
    const auto lowest = static_cast<std::int32_t>(begin), highest = static_cast<std::int32_t>(end - 1);
    for (std::size_t block = 0; block < blocks_.size(); ++block) {
        if (blocks_[block].highest < lowest || blocks_[block].lowest > highest) continue;
        const std::int32_t* corners = triangles_ + 3 * block * kTrianglesPerBlock;
        const std::int32_t* last = triangles_ + 3 * std::min(triangle_count_, (block + 1) * kTrianglesPerBlock);
        for (; corners != last; corners += 3) {
            const std::int32_t a = corners[0], b = corners[1], c = corners[2];
            if ((a == b) | (b == c) | (c == a)) continue;
            add(a, b, c);
            add(b, c, a);
            add(c, a, b);
        }
    }
    std::stable_sort(spilled_.begin(), spilled_.end(), [](const Spilled& a, const Spilled& b) { return a.index < b.index; });
}

// Rare, and kept out of the loop above.
void Corners::spill(const Spilled& corner) { spilled_.push_back(corner); }

void Corners::copy_link(std::size_t vertex, std::vector<LinkEdge>& link) const {
    const std::size_t index = vertex - begin_;
    link.clear();
    for (std::size_t i = 0; i < std::min<std::size_t>(counts_[index], kSlots); ++i) {
        link.push_back({slots_[index].from[i], slots_[index].to[i]});
    }
    if (counts_[index] <= kSlots) return;
    auto spilled = std::lower_bound(spilled_.begin(), spilled_.end(), index,
                                    [](const Spilled& entry, std::size_t wanted) { return entry.index < wanted; });
    for (; spilled != spilled_.end() && spilled->index == index; ++spilled) link.push_back(spilled->edge);
}

std::size_t window_size(const std::vector<VertexRange>& blocks, std::size_t vertex_count, int threads) {
    std::size_t visits = 0;
    for (const VertexRange& block : blocks) {
        visits += static_cast<std::size_t>(block.highest) / kSmallWindow - static_cast<std::size_t>(block.lowest) / kSmallWindow + 1;
    }
    if (visits <= 4 * blocks.size()) return kSmallWindow;
    return vertex_count / static_cast<std::size_t>(std::clamp(threads, 1, 64)) + 1;
}

}  // namespace isocore
