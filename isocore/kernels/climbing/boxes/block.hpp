// block.hpp - One block of N^3 cells as sign bits. Past the end of the volume the last sample is repeated, so ragged
// blocks need no special case elsewhere.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "climbing/boxes/dike.hpp"
#include "samples/signs.hpp"

namespace isocore::climbing {

template <int N>
class Block {
  public:
    using Word = typename DikeBits<N>::Word;

    // Reads the block that starts at sample `origin`.
    void load(const SignGrid& signs, const Dims& origin) {
        for (std::size_t a = 0; a < 3; ++a)
            cells[a] = static_cast<int>(std::min<std::size_t>(N, signs.dims[a] - 1 - origin[a]));
        const Word kept = static_cast<Word>((std::uint64_t{2} << cells[0]) - 1), beyond = DikeBits<N>::kSamples & ~kept;
        for (int k = 0; k <= N; ++k) {
            for (int j = 0; j <= N; ++j) {
                const SignRow row = signs.row(origin[1] + static_cast<std::size_t>(std::min(j, cells[1])),
                                              origin[2] + static_cast<std::size_t>(std::min(k, cells[2])));
                Word bits = static_cast<Word>(row.from(origin[0])) & kept;
                if (bits >> cells[0] & 1) bits |= beyond;
                rows[static_cast<std::size_t>(j)][static_cast<std::size_t>(k)] = bits;
            }
        }
    }

    std::array<std::array<Word, N + 1>, N + 1> rows;  // [j][k], bit i
    std::array<int, 3> cells{};                       // per axis; fewer than N at the volume's end
};

}  // namespace isocore::climbing
