// join_points.hpp - Which points of a mesh coincide.
// points: x, y, z of each, finite. Every point is joined with the lowest one it can be joined with, itself where that
// is none: exactly equal coordinates for a distance of 0 (-0.0 equals 0.0), else the lowest point not joined with
// another that lies within `distance`. So no two points that stand for others lie within the distance, and no chain of
// small steps joins what lies farther apart. Linear in the number of points.
#pragma once

#include <cstddef>
#include <cstdint>

#include "common/array.hpp"

namespace isocore {

struct JoinedPoints {
    Array<std::int32_t> number;  // per point: which of those that are left it became
    Array<std::int32_t> first;   // per point that is left: the lowest that became it; ascending
};

// Throws std::length_error for more points than an int32 can name.
JoinedPoints join_points(const double* points, std::size_t count, double distance);

}  // namespace isocore
