// fans.hpp - Vertices whose triangles are seen, from some direction, to lie around them side by side: none of these
// triangles meets another but at what they share. That settles nearly all pairs of triangles that share a corner.
#pragma once

#include <cstdint>

#include "common/array.hpp"
#include "surface/mesh_view.hpp"

namespace isocore::intersections {

// One entry per vertex: 1 where its triangles certainly lie side by side, 0 where that is not known. Coordinates must
// be finite. Throws std::invalid_argument if a triangle names a vertex that is not there.
template <class Real>
Array<std::uint8_t> tidy_fans(const MeshView<Real>& mesh, int threads);

}  // namespace isocore::intersections
