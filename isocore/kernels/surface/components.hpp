// components.hpp - Which vertices hang together.
// Every vertex first points to one earlier neighbour, or to where that one points: no vertex writes to another, so
// threads need not agree on anything. What those pointers miss is joined afterwards.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace isocore {

class Components {
public:
    using Pair = std::pair<std::int32_t, std::int32_t>;

    explicit Components(std::size_t count) : parent_(count) {
        for (std::size_t v = 0; v < count; ++v) {
            parent_[v].store(static_cast<std::int32_t>(v), std::memory_order_relaxed);
        }
    }

    // To be called at most once per vertex; several threads may.
    void hang_below(std::int32_t vertex, std::int32_t earlier) {
        at(vertex).store(at(earlier).load(std::memory_order_relaxed), std::memory_order_relaxed);
    }

    // Not to be called while others still hang. Returns whether the two were apart.
    bool join(Pair pair) {
        std::int32_t a = root_of(pair.first), b = root_of(pair.second);
        if (a == b) return false;
        if (a < b) std::swap(a, b);
        at(a).store(b, std::memory_order_relaxed);
        return true;
    }

private:
    std::atomic<std::int32_t>& at(std::int32_t v) { return parent_[static_cast<std::size_t>(v)]; }

    // Every step shortens the way for those who come later.
    std::int32_t root_of(std::int32_t v) {
        std::int32_t parent = at(v).load(std::memory_order_relaxed);
        while (parent != v) {
            const std::int32_t above = at(parent).load(std::memory_order_relaxed);
            at(v).store(above, std::memory_order_relaxed);
            v = parent;
            parent = above;
        }
        return v;
    }

    std::vector<std::atomic<std::int32_t>> parent_;
};

}  // namespace isocore
