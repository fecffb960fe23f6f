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

// A crossed grid edge: its axis and its lower sample.
struct RimEdge {
    int axis;
    Place at;
};

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

// Where an edge of a box lies: along which axis, and at which ends of the box along the other two.
struct Side {
    std::uint8_t axis;
    std::array<std::uint8_t, 2> across, high;
};
inline constexpr std::array<Side, 12> kSides = [] {
    std::array<Side, 12> sides{};
    for (int edge = 0; edge < 12; ++edge) {
        const auto across = cube::other_axes(edge / 4);
        sides[static_cast<std::size_t>(edge)] = {static_cast<std::uint8_t>(edge / 4),
                                                 {static_cast<std::uint8_t>(across[0]), static_cast<std::uint8_t>(across[1])},
                                                 {static_cast<std::uint8_t>(edge & 1), static_cast<std::uint8_t>(edge >> 1 & 1)}};
    }
    return sides;
}();

// The one crossing on a crossed edge of a simple box.
inline RimEdge box_crossing(const Site& site, const HighRice& box, std::size_t edge) {
    const auto& [axis, across, high] = kSides[edge];
    const std::array<const std::array<std::uint8_t, 3>*, 2> ends{&box.low, &box.high};
    const int first = (*ends[high[0]])[across[0]], second = (*ends[high[1]])[across[1]];
    RimEdge out{axis, {}};
    out.at[across[0]] = first;
    out.at[across[1]] = second;
    out.at[axis] = std::countr_zero(site.lign(axis, first, second) & ~std::uint64_t{0} << box.low[axis]);
    return out;
}

// Makes vertices of the crossings on the edges of a box; calls visit(number, edge) for those that were none.
template <class Visit>
void keep_edges(const Site& site, const HighRice& box, Layout& layout, const Visit& visit) {
    for (unsigned left = kCrossed[site.corners(box)]; left; left &= left - 1) {
        const RimEdge edge = box_crossing(site, box, static_cast<std::size_t>(std::countr_zero(left)));
        const std::size_t number = site.crossing(edge.axis, edge.at);
        if (layout.keep(number)) visit(number, edge);
    }
}

}  // namespace isocore::climbing
