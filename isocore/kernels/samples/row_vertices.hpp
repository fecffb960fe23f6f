// row_vertices.hpp - Writes the vertices of a row of grid edges. Words of edges are collected before the reader is
// called, so that its loop runs over many edges instead of ending, and being mispredicted, after each word.
#pragma once

#include <cstddef>
#include <type_traits>

#include "samples/crossed_edges.hpp"
#include "samples/sample_reader.hpp"

namespace isocore {

// Writes the vertices (x, y, z) of some crossed edges of row (j, k), in the order of crossed_edges.hpp, from `out` on,
// and returns the end. `edges(axis, w)` gives word w of the edges along an axis, a bit each; axis is a constant.
template <class Coordinate, class Edges>
Coordinate* write_row_vertices(const SampleReader& samples, const SignGrid& signs, std::size_t j, std::size_t k,
                               Coordinate* out, const Edges& edges) {
    CrossedWords found;
    const auto find = [&](auto axis) {
        for (std::size_t w = 0; w < signs.words; ++w) {
            found.add(edges(axis, w), {axis, 64 * w});
            if (found.full()) out = samples.write_vertices(j, k, found, out);
        }
    };
    find(std::integral_constant<int, 0>{});
    find(std::integral_constant<int, 1>{});
    find(std::integral_constant<int, 2>{});
    return found.empty() ? out : samples.write_vertices(j, k, found, out);
}

// The same for all crossed edges of the row.
template <class Coordinate>
Coordinate* write_row_vertices(const SampleReader& samples, const SignGrid& signs, std::size_t j, std::size_t k,
                               Coordinate* out) {
    return write_row_vertices(samples, signs, j, k, out,
                              [&](auto axis, std::size_t w) { return crossed_edges(signs, axis, j, k, w); });
}

}  // namespace isocore
