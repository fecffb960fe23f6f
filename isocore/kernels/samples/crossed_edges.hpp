// crossed_edges.hpp - One vertex per crossed grid edge, named without a hash: vertices are ordered by the row (j, k) of
// their edge's lower sample, within it by axis, within that by i. A vertex's number is therefore its row's base plus a
// rank query: the number of crossings before it, which is a popcount of sign bits. For one row of five samples, whose
// neighbours along axes 1 and 2 are `right` and `up`:
//
//     sample i    0 1 2 3 4
//     row         1 1 0 0 1        crossed along axis 0 = row ^ row >> 1    0 1 0 1 -      vertices base + 0, 1
//     right       1 0 0 0 1        crossed along axis 1 = row ^ right       0 1 0 0 0      vertex   base + 2
//     up          1 1 1 0 0        crossed along axis 2 = row ^ up          0 0 1 0 1      vertices base + 3, 4
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "samples/signs.hpp"

namespace isocore {

// The first vertex number of a row's edges along each axis.
using RowBase = std::array<std::uint32_t, 3>;

// The crossed ones among the 64 edges along `axis` that start in word w of row (j, k), a bit each; 0 for edges that
// would leave the volume.
inline std::uint64_t crossed_edges(const SignGrid& signs, int axis, std::size_t j, std::size_t k, std::size_t w) {
    const SignRow row = signs.row(j, k);
    if (axis == 0) return (row.word(w) ^ row.next_word(w)) & signs.valid(w, 1);
    if (axis == 1) return j + 1 < signs.dims[1] ? (row.word(w) ^ signs.row(j + 1, k).word(w)) & signs.valid(w) : 0;
    return k + 1 < signs.dims[2] ? (row.word(w) ^ signs.row(j, k + 1).word(w)) & signs.valid(w) : 0;
}

// How many edges along each axis that start in row (j, k) are crossed. Inline, since it runs once for every row: counts
// that a call returns through memory cost a short row more than counting does.
inline std::array<std::uint32_t, 3> count_crossings(const SignGrid& signs, std::size_t j, std::size_t k) {
    std::uint32_t x = 0, y = 0, z = 0;
    const auto ones = [](std::uint64_t word) { return static_cast<std::uint32_t>(std::popcount(word)); };
    for (std::size_t w = 0; w < signs.words; ++w) {
        x += ones(crossed_edges(signs, 0, j, k, w));
        y += ones(crossed_edges(signs, 1, j, k, w));
        z += ones(crossed_edges(signs, 2, j, k, w));
    }
    return {x, y, z};
}

}  // namespace isocore
