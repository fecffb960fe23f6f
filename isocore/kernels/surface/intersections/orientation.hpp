// orientation.hpp - On which side of a plane, or of a line, a point lies: in double where that can tell, else exactly,
// by common/predicates.hpp. Here stand the first tests alone, inline, with bounds as tight as can be, and their answer
// "cannot tell", which is all that most callers need. The bounds are those of J. R. Shewchuk, "Adaptive Precision
// Floating-Point Arithmetic and Fast Robust Geometric Predicates", Discrete & Computational Geometry 18(3), 1997.
#pragma once

#include <cmath>
#include <cstddef>

#include "common/predicates.hpp"
#include "surface/mesh_view.hpp"

namespace isocore::intersections {

// Half the distance from 1 to the next double.
constexpr double kEpsilon = 1.1102230246251565e-16;
constexpr double kPlaneBound = (7.0 + 56.0 * kEpsilon) * kEpsilon;
constexpr double kLineBound = (3.0 + 16.0 * kEpsilon) * kEpsilon;

inline int sign_of(double value) { return (value > 0) - (value < 0); }

// As plane_side, but 0 also where double precision cannot tell.
inline int likely_plane_side(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const Vec3 u = a - d, v = b - d, w = c - d;
    const double vw0 = v[1] * w[2], vw1 = v[2] * w[1];
    const double wu0 = w[1] * u[2], wu1 = w[2] * u[1];
    const double uv0 = u[1] * v[2], uv1 = u[2] * v[1];
    const double value = u[0] * (vw0 - vw1) + v[0] * (wu0 - wu1) + w[0] * (uv0 - uv1);
    const double size = std::abs(u[0]) * (std::abs(vw0) + std::abs(vw1)) +
                        std::abs(v[0]) * (std::abs(wu0) + std::abs(wu1)) +
                        std::abs(w[0]) * (std::abs(uv0) + std::abs(uv1));
    return std::abs(value) > kPlaneBound * size ? sign_of(value) : 0;
}

// The side of the plane through a, b, c on which d lies: -1 where a, b, c turn counter-clockwise seen from d, 0 on the
// plane.
inline int plane_side(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const int likely = likely_plane_side(a, b, c, d);
    return likely != 0 ? likely : -side_of_plane(a, b, c, d);
}

// Seen along `axis`, which way the corners a, b, c turn: 0 where double precision cannot tell.
inline int likely_line_side(std::size_t axis, const Vec3& a, const Vec3& b, const Vec3& c) {
    const std::size_t x = axis == 0 ? 1 : 0, y = axis == 2 ? 1 : 2;
    const double left = (a[x] - c[x]) * (b[y] - c[y]), right = (a[y] - c[y]) * (b[x] - c[x]);
    const double value = left - right;
    return std::abs(value) > kLineBound * (std::abs(left) + std::abs(right)) ? sign_of(value) : 0;
}

// The same, exactly; 0 where the three lie on one line as seen along `axis`.
inline int line_side(std::size_t axis, const Vec3& a, const Vec3& b, const Vec3& c) {
    const int likely = likely_line_side(axis, a, b, c);
    if (likely != 0) return likely;
    const int exact = turn(a, b, c, axis);  // of the two other axes in cyclic order, which for axis 1 is the other one
    return axis == 1 ? -exact : exact;
}

}  // namespace isocore::intersections
