// clusters.hpp - A coarse mesh to look at: the vertices of a cell of a grid that hang together there are one.
//
// After J. Rossignac, P. Borrel, "Multi-resolution 3D approximations for rendering complex scenes", Modeling in
// Computer Graphics, 1993; but sheets that pass through a cell side by side stay apart, so that folds are not glued
// together.
#pragma once

#include <cstddef>
#include <cstdint>

#include "common/array.hpp"
#include "surface/mesh_view.hpp"

namespace isocore {

struct Clusters {
    Array<std::int32_t> kept;       // the mesh's vertices that stand for a cluster each, ascending
    Array<std::int32_t> triangles;  // three each: which of these
};

// At most `most` triangles, and not many fewer where there are more. Coordinates are finite.
//
// A cluster's vertex is the one of its own that is nearest to their mean; on a border, to the mean of those there.
// Triangles between three clusters stay, in their order: a closed mesh stays closed, and no hole appears. Of pieces
// that have no such triangle the larger ones are kept as they are, as long as there is room; the others are lost.
//
// Throws std::invalid_argument if a triangle names a vertex that is not there.
template <class Real>
Clusters cluster(const MeshView<Real>& mesh, std::size_t most);

}  // namespace isocore
