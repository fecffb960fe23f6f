// cell_rows.hpp - A row of cells as the sign bits of the four rows of samples around it, 64 cells a word.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "samples/signs.hpp"

namespace isocore::marching_cubes {

using Word = std::uint64_t;

inline std::uint32_t ones(Word word) { return static_cast<std::uint32_t>(std::popcount(word)); }

// A row of cells, by the four rows of samples around it. Bit x of here(n, w) is the sign of row n's sample at the low
// end of cell 64 w + x, and bit x of next(n, w) that at its high end.
struct CellRow {
    std::array<SignRow, 4> row;  // (j, k), (j + 1, k), (j, k + 1), (j + 1, k + 1)

    CellRow(const SignGrid& signs, std::size_t j, std::size_t k)
        : row{signs.row(j, k), signs.row(j + 1, k), signs.row(j, k + 1), signs.row(j + 1, k + 1)} {}

    Word here(int n, std::size_t w) const { return row[static_cast<std::size_t>(n)].word(w); }
    Word next(int n, std::size_t w) const { return row[static_cast<std::size_t>(n)].next_word(w); }
    // The cells whose eight corners are not all alike, among those of the mask `valid`.
    Word active(std::size_t w, Word valid) const {
        Word any = 0, all = ~Word{0};
        for (int n = 0; n < 4; ++n) {
            const Word a = here(n, w), b = next(n, w);
            any |= a | b;
            all &= a & b;
        }
        return any & ~all & valid;
    }
};

}  // namespace isocore::marching_cubes
