// components.hpp - Which vertices hang together: a union-find that several threads may feed at once.
// A root is always the smallest vertex of its set so far, so the outcome does not depend on who came first.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace isocore {

class Components {
public:
    explicit Components(std::size_t count) : parent_(count) {
        for (std::size_t v = 0; v < count; ++v) {
            parent_[v].store(static_cast<std::int32_t>(v), std::memory_order_relaxed);
        }
    }

    bool is_root(std::size_t v) const {
        return parent_[v].load(std::memory_order_relaxed) == static_cast<std::int32_t>(v);
    }

    void join(std::int32_t a, std::int32_t b) {
        for (;;) {
            a = find(a);
            b = find(b);
            if (a == b) return;
            if (a < b) std::swap(a, b);
            std::int32_t expected = a;  // hang the larger root below the smaller, unless another thread was quicker
            if (at(a).compare_exchange_strong(expected, b, std::memory_order_relaxed)) return;
        }
    }

private:
    std::atomic<std::int32_t>& at(std::int32_t v) { return parent_[static_cast<std::size_t>(v)]; }

    // Every step shortens the way for those who come later (path halving). Parents only ever get smaller, so a
    // value that another thread has just replaced is still an ancestor.
    std::int32_t find(std::int32_t v) {
        std::int32_t parent = at(v).load(std::memory_order_relaxed);
        while (parent != v) {
            const std::int32_t above = at(parent).load(std::memory_order_relaxed);
            if (above != parent) at(v).store(above, std::memory_order_relaxed);
            v = parent;
            parent = above;
        }
        return v;
    }

    std::vector<std::atomic<std::int32_t>> parent_;
};

}  // namespace isocore
