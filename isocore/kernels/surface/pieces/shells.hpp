// shells.hpp - The shells of a mesh: the parts of it that share no vertex, how large they are, and whether they close.
// The words are explained in README.md. Results do not depend on the number of threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/array.hpp"
#include "surface/mesh_view.hpp"

namespace isocore {

struct Shell {
    std::int32_t first;  // its earliest vertex
    std::size_t triangles = 0;
    double area = 0;
    double volume = 0;  // signed, positive if normals point outside; means something only when closed
    bool closed = true;
};

struct Shells {
    std::vector<Shell> shells;      // in the order of their first vertices
    Array<std::int32_t> of_vertex;  // the number of its shell; -1 where no triangle uses it
};

// Triangles with a repeated corner take part in nothing. Throws std::invalid_argument if a triangle names a vertex that
// is not there.
template <class Real>
Shells shells_of(const MeshView<Real>& mesh, int threads);

}  // namespace isocore
