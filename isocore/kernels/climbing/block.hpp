// block.hpp - One block of N^3 cells as sign bits. Past the end of the volume the last sample is repeated, so ragged
// blocks need no special case elsewhere.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "climbing/dike.hpp"
#include "common/signs.hpp"

namespace isocore::climbing {

template <int N>
class Block {
  public:
    using Word = typename DikeBits<N>::Word;

    // Reads the block that starts at sample `origin`.
    void load(const SignGrid& signs, const Dims& origin) {
        for (std::size_t a = 0; a < 3; ++a) cells[a] = static_cast<int>(std::min<std::size_t>(N, signs.dims[a] - 1 - origin[a]));
        const std::size_t w = origin[0] / 64, shift = origin[0] % 64;
        const bool two_words = shift + static_cast<std::size_t>(cells[0]) >= 64;
        const Word kept = static_cast<Word>((std::uint64_t{2} << cells[0]) - 1), beyond = DikeBits<N>::kSamples & ~kept;
        for (int k = 0; k <= N; ++k) {
            for (int j = 0; j <= N; ++j) {
                const std::uint64_t* row = signs.row(origin[1] + static_cast<std::size_t>(std::min(j, cells[1])),
                                                     origin[2] + static_cast<std::size_t>(std::min(k, cells[2])));
                Word bits = static_cast<Word>(row[w] >> shift | (two_words ? row[w + 1] << 1 << (63 - shift) : 0)) & kept;
                if (bits >> cells[0] & 1) bits |= beyond;
                rows[static_cast<std::size_t>(j)][static_cast<std::size_t>(k)] = bits;
            }
        }
    }

    std::array<std::array<Word, N + 1>, N + 1> rows;  // [j][k], bit i
    std::array<int, 3> cells{};                       // per axis; fewer than N at the volume's end
};

// The rows of a bar, one laid over the other: which of its blocks have samples on both sides.
class BarShadow {
  public:
    // Of the bar of blocks of N^3 cells that starts at row (y, z).
    BarShadow(const SignGrid& signs, std::size_t N, std::size_t y, std::size_t z) : any_(signs.words + 1, 0), all_(signs.words + 1, ~std::uint64_t{0}) {
        for (std::size_t k = z; k < std::min(z + N + 1, signs.dims[2]); ++k) {
            for (std::size_t j = y; j < std::min(y + N + 1, signs.dims[1]); ++j) {
                const std::uint64_t* row = signs.row(j, k);
                for (std::size_t w = 0; w < signs.words; ++w) {
                    any_[w] |= row[w];
                    all_[w] &= row[w];
                }
            }
        }
    }

    // Does a block from sample x on hold any crossing, if it has so many cells along the bar?
    bool crosses(std::size_t x, std::size_t cells) const {
        const std::uint64_t samples = (std::uint64_t{2} << cells) - 1;
        const auto part = [&](const std::vector<std::uint64_t>& words) {
            const std::size_t w = x / 64, shift = x % 64;
            return (words[w] >> shift | words[w + 1] << 1 << (63 - shift)) & samples;
        };
        return part(any_) != 0 && part(all_) != samples;
    }

  private:
    std::vector<std::uint64_t> any_, all_;
};

}  // namespace isocore::climbing
