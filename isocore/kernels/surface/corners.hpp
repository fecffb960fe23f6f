// corners.hpp - The flat corner list of a mesh: for each vertex the edges opposite to it.
#pragma once

#include <cstddef>
#include <cstdint>

#include "common/array.hpp"

namespace isocore {

// The edge opposite to a corner, in the direction in which its triangle runs along it.
struct Opposite {
    std::int32_t from;
    std::int32_t to;
};

struct Corners {
    Array<std::uint32_t> first;  // first[v] .. first[v + 1] are the places of vertex v in `opposites`
    Array<Opposite> opposites;

    const Opposite* begin(std::size_t v) const { return opposites.data() + first[v]; }
    std::size_t count(std::size_t v) const { return first[v + 1] - first[v]; }
};

// Triangles with a repeated corner are left out. Indices must have been checked. The order of a vertex's corners
// is that of their triangles for any number of threads.
Corners list_corners(const std::int32_t* triangles, std::size_t triangle_count, std::size_t vertex_count,
                     int threads);

}  // namespace isocore
