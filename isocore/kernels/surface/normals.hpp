// normals.hpp - Unit vertex normals that point outside, that is towards lower values.
#pragma once

#include <cstddef>
#include <vector>

#include "common/array.hpp"
#include "common/grid.hpp"
#include "surface/mesh_view.hpp"

namespace isocore {

// From the samples: central differences (one-sided at the border and beside a non-finite sample), interpolated
// trilinearly at the vertex. Everything is in index space. `below`: a high sample is a low value. Where the gradient
// vanishes or contradicts the grid edge of the vertex, and for vertices beside the grid (a cap), the normal is that of
// the triangles, or, if normals are not to be complete, NaN.
template <class Sample, class Real>
Array<float> gradient_normals(GridView<const Sample> samples, const MeshView<Real>& mesh, bool below, bool complete,
                              int threads);

// From the triangles around each vertex, each weighing as much as its area; (0, 0, 1) where they cancel.
// Throws std::invalid_argument if a triangle names a vertex that is not there.
template <class Real>
Array<float> triangle_normals(const MeshView<Real>& mesh);

// The same for the vertices named by `wanted` alone, into normals (vertex_count, 3).
template <class Real>
void store_triangle_normals(const MeshView<Real>& mesh, const std::vector<std::size_t>& wanted, float* normals);

}  // namespace isocore
