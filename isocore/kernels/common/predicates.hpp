// predicates.hpp - On which side of a plane or of a line a point lies, without any rounding: the sign is that of real
// numbers. Where doubles can tell they do; else the determinant is expanded into a sum of doubles that is exact.
#pragma once

#include <array>
#include <cstddef>

namespace isocore {

using Point = std::array<double, 3>;

// 1 if d lies on the side of the plane a b c from which a, b, c turn counter-clockwise, -1 if on the other side, 0 if
// in the plane. Coordinates are finite, and their products of three neither overflow nor underflow.
int side_of_plane(const Point& a, const Point& b, const Point& c, const Point& d);

// 1 if a, b, c turn counter-clockwise, seen against `axis` (0, 1, 2) with the two other axes in their cyclic order; -1
// if clockwise, 0 if they lie on one line.
int turn(const Point& a, const Point& b, const Point& c, std::size_t axis);

}  // namespace isocore
