// high_rice.hpp - A highrice is a box of cells that gets its triangles in one piece, as the surface cuts one disk from
// it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace isocore::climbing {

// The box's first and last sample along each axis, counted from its block's origin; at most 32. A part of a block that
// lies past the volume's end has length 0 along some axis, and is no highrice.
struct HighRice {
    std::array<std::uint8_t, 3> low, high;

    int length(std::size_t axis) const { return high[axis] - low[axis]; }  // cells
    bool operator==(const HighRice&) const = default;
};

}  // namespace isocore::climbing
