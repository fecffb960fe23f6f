// bar_shadow.hpp - All rows of a bar, laid over each other: the OR and the AND of their sign bits. They tell which of
// its blocks have samples on both sides, so that only those are read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/bit_fields.hpp"
#include "samples/signs.hpp"

namespace isocore::climbing {

class BarShadow {
  public:
    // The shadow of the bar of blocks of N^3 cells whose first row is (y, z).
    BarShadow(const SignGrid& signs, std::size_t N, std::size_t y, std::size_t z);

    // Has the block of `cells` cells along x from sample x on samples on both sides?
    bool crosses(std::size_t x, std::size_t cells) const {
        const std::uint64_t samples = (std::uint64_t{2} << cells) - 1;
        return (bits_from(any_.data(), x) & samples) != 0 && (bits_from(all_.data(), x) & samples) != samples;
    }

  private:
    std::vector<std::uint64_t> any_, all_;  // one word more than a row has, as bits_from() may read it
};

}  // namespace isocore::climbing
