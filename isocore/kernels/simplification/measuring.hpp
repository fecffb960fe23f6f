// measuring.hpp - What is said of the result: how far it lies from the reference, both ways.
#pragma once

#include <vector>

#include "simplification/backward.hpp"
#include "simplification/mesh.hpp"
#include "simplification/types.hpp"

namespace isocore::simplification {

// Proves what is not proved yet within the limit, and measures how far each witness lies from its triangle, stretched
// as the mesh is and as `other` says. Adds it to the facts: of the whole, and of each sheet there is room for. A thread
// for each prover; what comes out does not depend on how many there are.
template <class Real>
void measure(Mesh<Real>& mesh, const std::vector<Backward<Real>*>& provers, float limit, const Spot& other,
             Facts& facts);

}  // namespace isocore::simplification
