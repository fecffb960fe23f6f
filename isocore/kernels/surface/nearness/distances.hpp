// distances.hpp - How far points lie from a surface.
#pragma once

#include <cstddef>

#include "surface/mesh_view.hpp"

namespace isocore {

struct Distances {
    double largest = 0, sum = 0, squares = 0;
};

// The distance of each of `count` points (count, 3) to the nearest triangle. The same for any number of threads.
// Coordinates must be finite. Throws std::invalid_argument if a triangle names a vertex that is not there, or where
// there are points and no triangles.
Distances distances_to(const MeshView<double>& mesh, const double* points, std::size_t count, int threads);

}  // namespace isocore
