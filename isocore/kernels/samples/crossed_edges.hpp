// crossed_edges.hpp - One vertex per crossed grid edge, named without a hash: vertices are ordered by the row (j, k) of
// their edge's lower sample, within it by axis, within that by i. A vertex's number is therefore its row's base plus a
// rank query: the number of crossings before it, which is a popcount of sign bits.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "samples/signs.hpp"

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

}  // namespace isocore
