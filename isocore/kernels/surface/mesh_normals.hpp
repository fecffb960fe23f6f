// mesh_normals.hpp - Unit vertex normals of a mesh's isosurface, from the gradients of the cells around it.
#pragma once

#include <cstddef>
#include <cstdint>

#include "common/array.hpp"
#include "common/mesh_field.hpp"
#include "surface/mesh_view.hpp"

namespace isocore {

struct CellsView {
    const std::int32_t *tets, *hexes;  // 4 and 8 point ids per cell, in VTK's order; either way round
    std::size_t tet_count, hex_count;
};

// The mesh edge that each of the first `count` vertices lies on: (count, 2) point ids, the lower one first.
struct EdgesView {
    const std::int32_t* ends;
    std::size_t count;
};

// At a point the gradient is the mean of those of its cells, each weighing as much as its volume; along an edge it is
// interpolated. Normals point to lower values. Where there is no gradient, where it contradicts the edge's own slope,
// and for vertices that lie on no edge, the normal is that of the triangles, or, if normals are not to be complete,
// NaN. The same for any number of threads. Throws std::invalid_argument if a point or a vertex is named that is not
// there.
template <class Value, class Real>
Array<float> mesh_normals(const mesh::Field<Value>& field, const CellsView& cells, double isovalue,
                          const EdgesView& edges, const MeshView<Real>& surface, bool complete, int threads);

}  // namespace isocore
