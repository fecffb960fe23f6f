// loop_cost.hpp - What a triangle of a loop costs: the loop is cut into those that cost least.
#pragma once

#include "common/lanes.hpp"
#include "common/vectors.hpp"

namespace isocore::climbing {

// Twice its area, eight triangles at once. normal: the cross product of two of its sides.
inline Floats double_area(const Vector<Floats>& normal) { return root(dot(normal, normal)); }

// Twice its area, times one more than its tilt at each corner: 1 less the cosine of the angle between its normal and
// the direction in which the samples fall there. falls: the sum of these three unit vectors, each to the triangle's
// outside.
//
// The criterion of the climbing paper, section 4, which rejects triangles by that angle and relaxes the threshold until
// the loop is closed. Were the direction the same everywhere, least area would be least tilt, as the areas times the
// cosines of all triangles add up to the same, however a loop is cut.
inline Floats tilted_area(const Vector<Floats>& normal, const Vector<Floats>& falls) {
    return Floats(4.0f) * double_area(normal) - dot(normal, falls);
}

}  // namespace isocore::climbing
