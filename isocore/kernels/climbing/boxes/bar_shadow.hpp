// bar_shadow.hpp - The rows of a bar, one laid over the other: they tell which of its blocks have samples on both
// sides, so that only those are read.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/bit_fields.hpp"
#include "samples/signs.hpp"

namespace isocore::climbing {

class BarShadow {
  public:
    // Of the bar of blocks of N^3 cells that starts at row (y, z).
    BarShadow(const SignGrid& signs, std::size_t N, std::size_t y, std::size_t z)
        : any_(signs.words + 1, 0), all_(signs.words + 1, ~std::uint64_t{0}) {
        for (std::size_t k = z; k < std::min(z + N + 1, signs.dims[2]); ++k) {
            for (std::size_t j = y; j < std::min(y + N + 1, signs.dims[1]); ++j) {
                const SignRow row = signs.row(j, k);
                for (std::size_t w = 0; w < signs.words; ++w) {
                    any_[w] |= row.word(w);
                    all_[w] &= row.word(w);
                }
            }
        }
    }

    // Does a block from sample x on hold any crossing, if it has so many cells along the bar?
    bool crosses(std::size_t x, std::size_t cells) const {
        const std::uint64_t samples = (std::uint64_t{2} << cells) - 1;
        return (bits_from(any_.data(), x) & samples) != 0 && (bits_from(all_.data(), x) & samples) != samples;
    }

  private:
    std::vector<std::uint64_t> any_, all_;
};

}  // namespace isocore::climbing
