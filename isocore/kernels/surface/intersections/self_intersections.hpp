// self_intersections.hpp - How many pairs of triangles meet that should not.
// A pair is counted once, however much of it meets: triangles that share no corner if they have a point in common, also
// if they only touch; triangles that share one corner or an edge if they have a point in common beyond it, as two that
// lie upon each other. Corners at one place are one. The words are explained in README.md.
#pragma once

#include <cstddef>

#include "surface/mesh_view.hpp"

namespace isocore {

// The exact number, for any number of threads. Triangles without area, and those with a corner that is not finite, meet
// nothing. Throws std::invalid_argument if a triangle names a vertex that is not there.
template <class Real>
std::size_t self_intersections(const MeshView<Real>& mesh, int threads);

}  // namespace isocore
