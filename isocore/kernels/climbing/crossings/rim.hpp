// rim.hpp - Where the surface crosses the twelve edges of a highrice, each at most once: those crossings are kept.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "climbing/crossings/layout.hpp"
#include "climbing/crossings/site.hpp"
#include "climbing/high_rice.hpp"
#include "tables/rims.hpp"

namespace isocore::climbing {

// The ends of a box along each axis: low, high, low, ...
using Ends = std::array<int, 6>;
inline Ends ends_of(const HighRice& box) {
    return {box.low[0], box.high[0], box.low[1], box.high[1], box.low[2], box.high[2]};
}

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
