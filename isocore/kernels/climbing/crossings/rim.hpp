// rim.hpp - Where the surface crosses the twelve edges of a highrice. As the box is simple, it crosses each at most
// once; those crossings are kept. This is for single boxes, halved late; rice_edges.hpp does a block's at once.
#pragma once

#include <array>
#include <bit>
#include <cstddef>

#include "climbing/crossings/layout.hpp"
#include "climbing/crossings/site.hpp"
#include "climbing/high_rice.hpp"
#include "tables/rims.hpp"

namespace isocore::climbing {

// The low and the high end of a box along x, then along y, then along z: what Side (rims.hpp) counts from 0 to 5.
using EndsByAxis = std::array<int, 6>;
inline EndsByAxis ends_of(const HighRice& box) {
    return {box.low[0], box.high[0], box.low[1], box.high[1], box.low[2], box.high[2]};
}

// Keeps the crossings on the edges of a box of the block that the site is loaded with. Calls visit(crossing, axis, at)
// for each that was not kept before: its number, and its edge as an axis and a lower sample.
template <class Visit>
void keep_edges(const Site& site, const HighRice& box, Layout& layout, const Visit& visit) {
    const EndsByAxis ends = ends_of(box);
    for (unsigned left = kCrossed[site.corners(box)]; left; left &= left - 1) {
        const Side& side = kSides[static_cast<std::size_t>(std::countr_zero(left))];
        Place at{ends[side.start[0]], ends[side.start[1]], ends[side.start[2]]};
        while (!site.is_crossed(side.axis, at)) ++at[side.axis];
        const std::size_t crossing = site.crossing(side.axis, at);
        if (layout.keep(crossing)) visit(crossing, side.axis, at);
    }
}

}  // namespace isocore::climbing
