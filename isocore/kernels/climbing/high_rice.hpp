// high_rice.hpp - A highrice is a box of cells that gets its triangles in one piece: the surface cuts a disk from it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace isocore::climbing {

// In samples from its block's origin; both ends belong to it.
struct HighRice {
    std::array<std::uint8_t, 3> low, high;

    int length(std::size_t axis) const { return high[axis] - low[axis]; }
    bool operator==(const HighRice&) const = default;
};

}  // namespace isocore::climbing
