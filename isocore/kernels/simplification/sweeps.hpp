// sweeps.hpp - In which order edges are contracted: by quadric error, in bands of a factor of two; in a band, vertices
// are swept in their order until none of them can go.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "simplification/contraction.hpp"

namespace isocore::simplification {

// Contracts edges from these vertices, which are movable, until no rule allows another, or `most` are contracted.
// costs: one for each vertex of the mesh, of which only those of movable ones are touched.
template <class Real>
void sweep(const std::vector<std::int32_t>& vertices, Mesh<Real>& mesh, Contraction<Real>& contraction,
           std::vector<float>& costs, std::size_t most);

}  // namespace isocore::simplification
