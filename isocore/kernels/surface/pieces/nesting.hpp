// nesting.hpp - Which shells lie in which, and so which of them make up a piece. README.md explains the words.
#pragma once

#include <cstdint>

#include "common/array.hpp"
#include "surface/mesh_view.hpp"
#include "surface/pieces/shells.hpp"

namespace isocore {

struct Nesting {
    // Of each shell, the smallest closed one around it that faces the other way; -1 where there is none.
    Array<std::int32_t> around;
    Array<std::int32_t> piece;  // of each shell, the outer shell of its piece: itself, unless it is a bubble
};

// mesh: that of which `shells` are; shells that pass through each other are nested by their first vertices. The result
// does not depend on the number of threads.
template <class Real>
Nesting nesting_of(const MeshView<Real>& mesh, const Shells& shells, int threads);

}  // namespace isocore
