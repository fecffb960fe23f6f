// tilt.hpp - How far triangles are turned from the gradients at their corners.
#pragma once

#include <cstddef>

#include "surface/mesh_view.hpp"
#include "surface/place.hpp"

namespace isocore {

// Angles in degrees, over all corners of all triangles: their mean, what 95 % of them do not exceed, and the largest.
// count: how many there are; the rest is 0 if there is none.
struct Tilt {
    double mean = 0, p95 = 0, max = 0;
    std::size_t count = 0;
};

// The angles between each triangle's normal and the unit normals at its corners, once both went through the affine as
// planes do. normals: (vertex_count, 3); corners where they are NaN, and triangles without an area, are left out.
// The same for any number of threads. Throws std::invalid_argument if a triangle names a vertex that is not there, or
// if the affine is singular.
template <class Real>
Tilt tilt(const MeshView<Real>& mesh, const float* normals, const Affine& affine, int threads);

}  // namespace isocore
