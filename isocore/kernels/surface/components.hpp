// components.hpp - The connected components of a mesh's vertices, by union-find.
// Every window of vertices is joined within itself, by one thread and without locks; edges that reach from one window
// into an earlier one are joined afterwards. A component's root is its earliest vertex.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>

#include "common/array.hpp"

namespace isocore {

class Components {
  public:
    using Pair = std::pair<std::int32_t, std::int32_t>;

    explicit Components(std::size_t count) : parent_(count) {}

    // Makes vertices begin .. end - 1 components of their own; before this no other call may name them.
    void start(std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) parent_[v] = static_cast<std::int32_t>(v);
    }

    // Joins a vertex that is still a component of its own with an earlier one, without a search for its root.
    void hang_below(std::int32_t vertex, std::int32_t earlier) { at(vertex) = at(earlier); }

    // Returns whether the two were apart.
    bool join(Pair pair) {
        std::int32_t a = root_of(pair.first), b = root_of(pair.second);
        if (a == b) return false;
        if (a < b) std::swap(a, b);
        at(a) = b;
        return true;
    }

    // Are two known to be of one component, without a search? Most that were joined are.
    bool are_close(std::int32_t a, std::int32_t b) { return at(a) == at(b); }

    // The earliest vertex of its component. Path splitting: every step shortens the path of later searches.
    std::int32_t root_of(std::int32_t v) {
        std::int32_t parent = at(v);
        while (parent != v) {
            const std::int32_t above = at(parent);
            at(v) = above;
            v = parent;
            parent = above;
        }
        return v;
    }

  private:
    std::int32_t& at(std::int32_t v) { return parent_[static_cast<std::size_t>(v)]; }

    Array<std::int32_t> parent_;
};

}  // namespace isocore
