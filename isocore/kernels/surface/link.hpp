// link.hpp - What the edges around one vertex say, read from its link alone.
#pragma once

#include <cstddef>

#include "surface/corners.hpp"

namespace isocore {

// Edges at one vertex. Summed over all vertices every edge comes twice, from each of its ends.
struct EdgeCounts {
    std::size_t edges = 0;
    std::size_t boundary = 0;
    std::size_t nonmanifold = 0;
    std::size_t misoriented = 0;
};

// True if the link is one ring that all triangles run along in one direction: then every edge at the vertex has
// exactly two triangles, in opposite directions. False also for rings too long to be looked at cheaply.
bool is_plain_ring(const Opposite* link, std::size_t count);

// Adds the edges around any vertex to `counts`; returns whether the link is one ring or one fan.
bool inspect_link(const Opposite* link, std::size_t count, EdgeCounts& counts);

}  // namespace isocore
