// measure.hpp - What a mesh is: its size, and whether it is a closed, oriented, manifold surface.
// The result does not depend on the number of threads: counts are exact, and sums are taken block by block in a
// fixed order. The words are explained in README.md.
#pragma once

#include <array>
#include <cstddef>

#include "surface/mesh_view.hpp"

namespace isocore {

struct Measured {
    std::size_t components = 0;
    std::size_t edges = 0;
    std::size_t boundary_edges = 0;
    std::size_t nonmanifold_edges = 0;
    std::size_t misoriented_edges = 0;
    std::size_t nonmanifold_vertices = 0;
    std::size_t used_vertices = 0;
    std::size_t degenerate = 0;
    std::ptrdiff_t euler = 0;
    double area = 0;
    double volume = 0;  // signed, positive if normals point outside; means something only when closed
    std::array<double, 6> bounds{};
};

// Throws std::invalid_argument if a triangle names a vertex that is not there.
template <class Real>
Measured measure(const MeshView<Real>& mesh, int threads);

}  // namespace isocore
