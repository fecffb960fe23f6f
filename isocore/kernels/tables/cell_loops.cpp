#include "tables/cell_loops.hpp"

#include "tables/derive_loops.hpp"

namespace isocore::cell_loops {

// Derived as a constexpr value first: initialising the table itself, g++ evaluates every call anew instead of once.
static constexpr CaseTable kDerived = derivation::derive<Case>(derivation::FaceDiagonals::shared_out);

constinit const CaseTable kTable = kDerived;

}  // namespace isocore::cell_loops
