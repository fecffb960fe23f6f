// edge_vertices.hpp - One vertex per crossed grid edge, named without a hash: vertices are ordered by the row (j, k) of
// their edge's lower sample, within it by axis, within that by i. A vertex's number is therefore its row's base plus
// the number of crossings before it, which is a popcount of sign bits.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "common/array.hpp"
#include "common/crossing.hpp"
#include "common/grid.hpp"
#include "common/signs.hpp"

namespace isocore {

// The first vertex number of a row's edges along each axis.
using RowBase = std::array<std::uint32_t, 3>;

// Crossings of the edges along `axis` that start in word w of row (j, k); 0 where the volume ends.
inline std::uint64_t crossed_edges(const SignGrid& signs, int axis, std::size_t j, std::size_t k, std::size_t w) {
    const std::uint64_t* row = signs.row(j, k);
    if (axis == 0) return (row[w] ^ next_samples(row, w, signs.words)) & signs.valid(w, 1);
    if (axis == 1) return j + 1 < signs.dims[1] ? row[w] ^ signs.row(j + 1, k)[w] : 0;
    return k + 1 < signs.dims[2] ? row[w] ^ signs.row(j, k + 1)[w] : 0;
}

// Writes the vertices of row (j, k) in order, from `out` on, and returns the end.
template <class Sample, class Coordinate>
Coordinate* write_row_vertices(const GridView<Sample>& samples, const SignGrid& signs, double isovalue, std::size_t j,
                               std::size_t k, Coordinate* out) {
    const std::size_t pad = signs.pad;
    for (int axis = 0; axis < 3; ++axis) {
        const std::size_t along = axis == 1 ? j : k, last = signs.dims[static_cast<std::size_t>(axis)] - 2;
        for (std::size_t w = 0; w < signs.words; ++w) {
            for (std::uint64_t left = crossed_edges(signs, axis, j, k, w); left != 0; left &= left - 1) {
                const std::size_t i = 64 * w + static_cast<std::size_t>(std::countr_zero(left));
                const std::size_t start = axis == 0 ? i : along;
                double t;
                if (pad && start == 0) {
                    t = 1 - kClamp;
                } else if (pad && start == last) {
                    t = kClamp;
                } else {
                    const Sample* low = samples.data + samples.index(i - pad, j - pad, k - pad);
                    t = crossing(low[0], low[samples.step(axis)], isovalue);
                }
                double place[3] = {static_cast<double>(i) - static_cast<double>(pad), static_cast<double>(j) - static_cast<double>(pad),
                                   static_cast<double>(k) - static_cast<double>(pad)};
                place[axis] += t;
                for (int a = 0; a < 3; ++a) *out++ = static_cast<Coordinate>(place[a]);
            }
        }
    }
    return out;
}

}  // namespace isocore
