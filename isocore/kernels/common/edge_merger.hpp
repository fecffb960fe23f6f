// edge_merger.hpp - From the crossed edges of all cells, each named by its two point ids and seen once per cell, to one
// vertex each: a radix sort into ranges of the lower point, then by it, then a look at the few edges that leave it.
// Vertices are numbered by lower point, then by first appearance, whatever the number of threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/array.hpp"

namespace isocore {

struct MeshEdge {
    std::int32_t low, high;  // point ids, low < high; equal ones name no edge and get vertex -1
};

struct Merged {
    Array<MeshEdge> edges;          // one per vertex
    Array<std::int32_t> vertex_of;  // one per edge seen
};

// `seen` comes in runs that were found apart; `points` is the number of points.
Merged merge_edges(const std::vector<Array<MeshEdge>>& seen, std::size_t points, int threads);

}  // namespace isocore
