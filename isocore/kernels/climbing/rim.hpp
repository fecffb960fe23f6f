// rim.hpp - Where the surface crosses the twelve edges of a highrice, each at most once: those crossings are kept.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "climbing/high_rice.hpp"
#include "climbing/layout.hpp"
#include "climbing/site.hpp"
#include "common/cube.hpp"

namespace isocore::climbing {

// The crossed edges of a box, by its corner signs.
inline constexpr std::array<std::uint16_t, 256> kCrossed = [] {
    std::array<std::uint16_t, 256> crossed{};
    for (unsigned corners = 0; corners < 256; ++corners) {
        for (int edge = 0; edge < 12; ++edge) {
            const unsigned low = corners >> cube::low_corner(edge) & 1, high = corners >> cube::high_corner(edge) & 1;
            crossed[corners] |= static_cast<std::uint16_t>((low ^ high) << edge);
        }
    }
    return crossed;
}();

// The ends of a box along each axis: low, high, low, ...
using Ends = std::array<int, 6>;
inline Ends ends_of(const HighRice& box) {
    return {box.low[0], box.high[0], box.low[1], box.high[1], box.low[2], box.high[2]};
}

// Where an edge of a box lies: along which axis, at which of the ends along the other two, and its start as three of
// them.
struct Side {
    std::uint8_t axis;
    std::array<std::uint8_t, 2> ends;
    std::array<std::uint8_t, 3> start;
};
inline constexpr std::array<Side, 12> kSides = [] {
    std::array<Side, 12> sides{};
    for (int edge = 0; edge < 12; ++edge) {
        const auto across = cube::other_axes(edge / 4);
        Side& side = sides[static_cast<std::size_t>(edge)];
        side.axis = static_cast<std::uint8_t>(edge / 4);
        for (unsigned a = 0; a < 3; ++a)
            side.start[a] = static_cast<std::uint8_t>(2 * a + (cube::low_corner(edge) >> a & 1));
        side.ends = {side.start[static_cast<std::size_t>(across[0])], side.start[static_cast<std::size_t>(across[1])]};
    }
    return sides;
}();

// Makes vertices of the crossings on the edges of a box; calls visit(number, axis, place) for those that were none.
template <class Visit>
void keep_edges(const Site& site, const HighRice& box, Layout& layout, const Visit& visit) {
    const Ends ends = ends_of(box);
    for (unsigned left = kCrossed[site.corners(box)]; left; left &= left - 1) {
        const Side& side = kSides[static_cast<std::size_t>(std::countr_zero(left))];
        Place at{ends[side.start[0]], ends[side.start[1]], ends[side.start[2]]};
        while (!site.is_crossed(side.axis, at)) ++at[side.axis];
        const std::size_t number = site.crossing(side.axis, at);
        if (layout.keep(number)) visit(number, side.axis, at);
    }
}

}  // namespace isocore::climbing
