// link.hpp - What the edges around one vertex say, read from its link alone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "surface/corners.hpp"

namespace isocore {

// Edges at one vertex. Summed over all vertices every edge comes twice, from each of its ends.
struct EdgeCounts {
    std::size_t edges = 0;
    std::size_t boundary = 0;
    std::size_t nonmanifold = 0;
    std::size_t misoriented = 0;
};

// Inspects one link after the other. Its members are scratch memory, kept to spare allocations.
class LinkInspector {
  public:
    // Adds the edges around any vertex to `counts`; returns whether the link is one ring or one fan.
    bool inspect(const Link& link, EdgeCounts& counts);

  private:
    struct Use {
        std::int32_t neighbour;
        bool is_from;  // the triangle runs from the vertex in the middle to this neighbour
    };

    bool count_edges(EdgeCounts& counts);
    std::size_t root_of(std::int32_t neighbour);

    std::vector<Use> uses_;
    std::vector<std::int32_t> neighbours_;
    std::vector<std::size_t> parents_;
};

}  // namespace isocore
