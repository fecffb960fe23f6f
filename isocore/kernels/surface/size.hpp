// size.hpp - How large a mesh is: its box, area and volume.
// Sums are rounded block by block, in an order that depends on nothing but the triangles.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "surface/corners.hpp"
#include "surface/mesh_view.hpp"

namespace isocore {

// Lowest and highest x, y, z, NaN left out; zeros where there is nothing.
template <class Real>
std::array<double, 6> bounds(const Real* vertices, std::size_t count);

struct Size {
    std::array<double, 6> bounds{};  // of all vertices, used or not
    double doubled_area = 0;
    double sixfold_volume = 0;
    std::size_t degenerate = 0;       // with a repeated corner, or of area zero
    std::vector<VertexRange> ranges;  // one for each block of triangles
};

// Throws std::invalid_argument if a triangle names a vertex that is not there.
template <class Real>
Size size_of(const MeshView<Real>& mesh, int threads);

// The same ranges alone.
template <class Real>
std::vector<VertexRange> ranges_of(const MeshView<Real>& mesh, int threads);

}  // namespace isocore
