// thinner.hpp - From all cells of a glued mesh to its extrema skeleton.
// heights: one per point of `points`, minus infinity where the value is not finite. What remains is connected within
// every component of the mesh, holds every local minimum and maximum, and carries every loop; so it meets every
// component of every isosurface (proved in docs/proofs/thinning.md). Ties are broken by point id. Linear in the number
// of cells; the same for any number of threads.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "common/array.hpp"
#include "thinning/mesh/gluing.hpp"

namespace isocore::thinning {

// How the work is shared: on how many threads, which changes nothing, and in blocks of how many cells; 0 for as many as
// is best.
struct Work {
    int threads = 1;
    std::size_t cells_per_block = 0;
};

struct Skeleton {
    Array<std::int32_t> cells;  // ascending
    std::size_t extrema = 0;    // points that are a local minimum or maximum
};

template <class Cell>
Skeleton thin(const Gluing<Cell>& gluing, const Array<double>& heights, Work work);

// Skeleton cells by the number of their face neighbours among the skeleton.
template <class Cell>
std::array<std::size_t, 7> classes_of(const Gluing<Cell>& gluing, const Array<std::int32_t>& skeleton);

}  // namespace isocore::thinning
