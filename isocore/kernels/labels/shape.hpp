// shape.hpp - A mesh without its places, and what smoothing wants to know of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "labels/label_mesh.hpp"

namespace isocore::labels {

struct Shape {
    std::span<const Element> elements;
    std::span<const std::int32_t> triangles;
    bool may_be_open;
};

// Of an open ring of neighbours its last, which no triangle names first; of a closed one kNone. For every vertex, or
// for none if all rings are closed.
inline constexpr std::uint32_t kNone = 0xFFFFFFFF;
std::vector<std::uint32_t> find_ends(const Shape& shape);

// The vertices begin to end - 1, and among the triangles first to last - 1 all that touch them.
struct Share {
    std::size_t begin, end, first, last;

    bool holds(std::int32_t vertex) const { return static_cast<std::size_t>(vertex) - begin < end - begin; }
};

// One for each thread. Vertices are numbered much as triangles are, so that shares have little in common.
std::vector<Share> find_shares(const Shape& shape, int threads);

// How far apart the numbers of a triangle's corners are at most.
std::size_t farthest_corners(std::span<const std::int32_t> triangles, int threads);

}  // namespace isocore::labels
