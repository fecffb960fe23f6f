// apart.hpp - The first phase, box by box, each with a mesh of its own, of which only what is left is kept. So the
// whole mesh is never there with all that contraction wants to know of it.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "simplification/reference.hpp"
#include "simplification/types.hpp"

namespace isocore::simplification {

// How many edges were contracted, and how many were not: by sheet, and by Rule.
struct Tally {
    std::size_t collapses = 0;
    std::vector<std::array<std::size_t, kRules>> refused;

    void add(const Tally& other);
};

// Contracts what can be in the boxes that are not shifted; what is left becomes the mesh, which is empty. by_cubes: the
// input's triangles, where it is not its own reference. limit: the bound, in stretched coordinates.
template <class Real>
Tally contract_apart(const MeshArrays<Real>& input, const Reference<Real>& reference, std::optional<CellIndex> by_cubes,
                     float limit, const Options& options, Mesh<Real>& mesh);

}  // namespace isocore::simplification
