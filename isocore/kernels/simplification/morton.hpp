// morton.hpp - The order of Morton: cells close to each other are mostly close in it, too.
#pragma once

#include <cstddef>
#include <cstdint>

#include "simplification/cells.hpp"

namespace isocore::simplification {

// Where a cell comes in that order. Cells of a brick, which is this power of two of cells wide, come together.
inline std::uint64_t morton(const Cell& cell, int brick_bits) {
    const auto spread = [](std::uint64_t n) {  // the bits of a number of up to 21 bits, two places apart
        n = (n | n << 32) & 0x1f00000000ffff;
        n = (n | n << 16) & 0x1f0000ff0000ff;
        n = (n | n << 8) & 0x100f00f00f00f00f;
        n = (n | n << 4) & 0x10c30c30c30c30c3;
        return (n | n << 2) & 0x1249249249249249;
    };
    std::uint64_t out = 0;
    for (std::size_t a = 0; a < 3; ++a) out |= spread(static_cast<std::uint64_t>(cell[a] >> brick_bits)) << a;
    return out;
}

inline constexpr int kBrickBits = 2;  // of the bricks by which vertices are numbered

}  // namespace isocore::simplification
