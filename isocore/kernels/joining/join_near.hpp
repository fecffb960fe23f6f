// join_near.hpp - Points within a distance that is more than the coordinates' own steps; see join_points.hpp.
#pragma once

#include <cstddef>

#include "joining/join_points.hpp"

namespace isocore {

JoinedPoints join_near(const double* points, std::size_t count, double distance);

}  // namespace isocore
