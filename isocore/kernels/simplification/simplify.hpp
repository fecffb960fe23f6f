// simplify.hpp - Simplification: the public function.
#pragma once

#include "simplification/types.hpp"

namespace isocore::simplification {

// The surface with as few triangles as the bound allows, by contracting edges onto one of their ends.
//
// input: a mesh. reference: the surface that it stands for, of which its vertices are vertices; the input itself, the
// same arrays, where it is the reference. Triangles turn counter-clockwise seen from outside.
//
// Vertices are the input's, bit for bit, and vertices and triangles keep their order. Components, their Euler numbers
// and their borders are the input's. If no two of the input's triangles meet but at common sides and corners, no two of
// the result's do. If the reference's vertices lie within the bound of the input, they lie within it of the result; the
// result's points lie within the bound of the reference but for the facts' `unproved` triangles, which are the input's.
// The same bytes for any number of threads.
//
// Throws std::invalid_argument if a triangle names a vertex that is not there.
template <class Real>
Simplified<Real> simplify(const MeshArrays<Real>& input, const MeshArrays<Real>& reference, const Options& options);

}  // namespace isocore::simplification
