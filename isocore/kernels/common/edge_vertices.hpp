// edge_vertices.hpp - One vertex per crossed grid edge, named without a hash: vertices are ordered by the row (j, k) of
// their edge's lower sample, within it by axis, within that by i. A vertex's number is therefore its row's base plus
// the number of crossings before it, which is a popcount of sign bits.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "common/array.hpp"
#include "common/crossing.hpp"
#include "common/grid.hpp"
#include "common/set_bits.hpp"
#include "common/signs.hpp"

namespace isocore {

// The first vertex number of a row's edges along each axis.
using RowBase = std::array<std::uint32_t, 3>;

// Crossings of the edges along `axis` that start in word w of row (j, k); 0 where the volume ends.
inline std::uint64_t crossed_edges(const SignGrid& signs, int axis, std::size_t j, std::size_t k, std::size_t w) {
    const SignRow row = signs.row(j, k);
    if (axis == 0) return (row.word(w) ^ row.next_word(w)) & signs.valid(w, 1);
    if (axis == 1) return j + 1 < signs.dims[1] ? (row.word(w) ^ signs.row(j + 1, k).word(w)) & signs.valid(w) : 0;
    return k + 1 < signs.dims[2] ? (row.word(w) ^ signs.row(j, k + 1).word(w)) & signs.valid(w) : 0;
}

// Where an edge into the padding is crossed: next to the volume's own sample. 0 for any other edge.
inline double border_crossing(const SignGrid& signs, int axis, std::size_t i, std::size_t j, std::size_t k) {
    if (!signs.pad) return 0;
    const std::size_t start = axis == 0 ? i : axis == 1 ? j : k;
    return start == 0 ? 1 - kClamp : start == signs.dims[static_cast<std::size_t>(axis)] - 2 ? kClamp : 0;
}

// The lower sample of a grid edge that is not in the padding.
template <class Sample>
const Sample* edge_start(const GridView<Sample>& samples, const SignGrid& signs, std::size_t i, std::size_t j,
                         std::size_t k) {
    return samples.data + samples.index(i - signs.pad, j - signs.pad, k - signs.pad);
}

// Where the grid edge along `axis` that starts at sample (i, j, k) is crossed, as a share of the way.
template <class Sample>
double edge_crossing(const GridView<Sample>& samples, const SignGrid& signs, double isovalue, int axis, std::size_t i,
                     std::size_t j, std::size_t k) {
    if (const double share = border_crossing(signs, axis, i, j, k); share > 0) return share;
    const Sample* low = edge_start(samples, signs, i, j, k);
    return crossing(low[0], low[samples.step(axis)], isovalue);
}

// The same as a quotient that is yet to be divided and clamped, for those who do so with several at once.
struct Quotient {
    float part, whole;
};
template <class Sample>
Quotient edge_quotient(const GridView<Sample>& samples, const SignGrid& signs, double isovalue, int axis, std::size_t i,
                       std::size_t j, std::size_t k) {
    if constexpr (std::is_integral_v<Sample>) {
        if (const double share = border_crossing(signs, axis, i, j, k); share > 0)
            return {static_cast<float>(share), 1};
        const Sample* low = edge_start(samples, signs, i, j, k);
        const double from = static_cast<double>(low[0]);
        return {static_cast<float>(isovalue - from),
                static_cast<float>(static_cast<double>(low[samples.step(axis)]) - from)};
    } else {
        return {static_cast<float>(edge_crossing(samples, signs, isovalue, axis, i, j, k)), 1};
    }
}

// Writes the vertex on that edge, and returns its end.
template <class Sample, class Coordinate>
Coordinate* write_vertex(const GridView<Sample>& samples, const SignGrid& signs, double isovalue, int axis,
                         std::size_t i, std::size_t j, std::size_t k, Coordinate* out) {
    const double pad = static_cast<double>(signs.pad), share = edge_crossing(samples, signs, isovalue, axis, i, j, k);
    const std::array<std::size_t, 3> at{i, j, k};
    for (int a = 0; a < 3; ++a) {
        *out++ = static_cast<Coordinate>(static_cast<double>(at[static_cast<std::size_t>(a)]) - pad +
                                         (a == axis ? share : 0.0));
    }
    return out;
}

// Writes the vertices of row (j, k) in order, from `out` on, and returns the end: those of the edges along each axis
// whose bits `edges(axis, w)` gives.
template <class Sample, class Coordinate, class Edges>
Coordinate* write_row_vertices(const GridView<Sample>& samples, const SignGrid& signs, double isovalue, std::size_t j,
                               std::size_t k, Coordinate* out, const Edges& edges) {
    struct Word {
        int axis;
        std::size_t first;
    };
    SetBits<Word, 32> found;
    const auto write = [&] {
        found.visit([&](const Word& word, int bit) {
            out = write_vertex(samples, signs, isovalue, word.axis, word.first + static_cast<std::size_t>(bit), j, k,
                               out);
        });
    };
    const auto find = [&](auto axis) {
        for (std::size_t w = 0; w < signs.words; ++w) {
            found.add(edges(axis, w), {axis, 64 * w});
            if (found.full()) write();
        }
    };
    find(std::integral_constant<int, 0>{});
    find(std::integral_constant<int, 1>{});
    find(std::integral_constant<int, 2>{});
    write();
    return out;
}

template <class Sample, class Coordinate>
Coordinate* write_row_vertices(const GridView<Sample>& samples, const SignGrid& signs, double isovalue, std::size_t j,
                               std::size_t k, Coordinate* out) {
    return write_row_vertices(samples, signs, isovalue, j, k, out,
                              [&](auto axis, std::size_t w) { return crossed_edges(signs, axis, j, k, w); });
}

}  // namespace isocore
