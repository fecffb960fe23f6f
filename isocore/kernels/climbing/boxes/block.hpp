// block.hpp - One block of N^3 cells as sign bits. Past the end of the volume the last sample is repeated, so ragged
// blocks need no special case elsewhere.
#pragma once

#include <array>

#include "climbing/boxes/dike.hpp"
#include "samples/signs.hpp"

namespace isocore::climbing {

// Instantiated in block.cpp for N = 1, 2, 4, 8, 16 and 32.
template <int N>
class Block {
  public:
    using Word = typename DikeBits<N>::Word;

    // Reads the block that starts at sample `origin`.
    void load(const SignGrid& signs, const Dims& origin);

    std::array<std::array<Word, N + 1>, N + 1> rows;  // [j][k], bit i: is sample (i, j, k) inside?
    std::array<int, 3> cells{};                       // per axis; fewer than N at the volume's end
};

}  // namespace isocore::climbing
