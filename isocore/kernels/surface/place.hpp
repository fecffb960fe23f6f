// place.hpp - Moving a mesh: vertices through an affine, triangles turned over, normals along.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "common/affine.hpp"
#include "surface/mesh_view.hpp"

namespace isocore {

// The cofactors of the linear part, row by row: the inverse transpose times the determinant, exact where the entries
// are.
std::array<Vec3, 3> cofactors(const Affine& affine);

// out[v] = affine * (vertices[v], 1), computed in double and rounded once. `out` may be `vertices`.
template <class From, class To>
void place(const From* vertices, std::size_t count, const Affine& affine, To* out, int threads);

// Swaps the last two corners of every triangle.
void flip(std::int32_t* triangles, std::size_t count, int threads);

// Brings normals along with vertices that go through `affine`: by the inverse transpose, then to unit length.
// Throws std::invalid_argument if the affine is singular.
void turn_normals(float* normals, std::size_t count, const Affine& affine, int threads);

}  // namespace isocore
