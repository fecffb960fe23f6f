// boxes.hpp - The boxes of a phase, with what of the mesh is to be looked at in each.
#pragma once

#include <cstdint>
#include <vector>

#include "simplification/cells.hpp"
#include "simplification/mesh.hpp"
#include "simplification/types.hpp"

namespace isocore::simplification {

struct MeshBox {
    Cell low, high;                       // its cells, both included
    std::vector<std::int32_t> vertices;   // those that lie in it with all their neighbours, and so may move
    std::vector<std::int32_t> triangles;  // all that touch it
};

// Those in which vertices may move, which are noted in the mesh; boxes with many of them come first. shift: how many
// cells the boxes begin before the first cell, along each axis.
template <class Real>
std::vector<MeshBox> find_boxes(Mesh<Real>& mesh, const Cells& cells, const Cell& shift, int threads);

}  // namespace isocore::simplification
