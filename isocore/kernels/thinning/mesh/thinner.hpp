// thinner.hpp - From all cells of a glued mesh to its extrema skeleton.
// heights: one per point, minus infinity where the value is not finite. What remains is connected within every
// component of the mesh, holds every local minimum and maximum, and carries every loop; so it meets every component of
// every isosurface (proved in docs/proofs/thinning.md, section 2). Ties are broken by point id. Linear in the number of
// cells.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "common/array.hpp"
#include "thinning/mesh/gluing.hpp"

namespace isocore::thinning {

struct Skeleton {
    Array<std::int32_t> cells;             // ascending
    std::size_t extrema = 0;               // vertices that are a local minimum or maximum
    std::size_t outside_components = 0;    // pieces of boundary that are still apart: one per body, and its voids
    std::array<std::size_t, 7> classes{};  // skeleton cells by the number of face neighbours among them
};

template <class Cell>
Skeleton thin(const Gluing<Cell>& gluing, const double* heights);

}  // namespace isocore::thinning
