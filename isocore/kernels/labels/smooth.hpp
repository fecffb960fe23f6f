// smooth.hpp - Smooths surfaces whose vertices lie in grid edges, faces and cells. Every vertex stays inside its own,
// so that every sample keeps its side, and no triangle comes to cut another.
//
// `rounds` are steps with the two factors of Taubin 1995 by turns: one smooths, the next undoes the shrinking. The same
// bytes for any number of threads.
#pragma once

#include <cstddef>
#include <cstdint>

#include "labels/label_mesh.hpp"

namespace isocore::labels {

// The mesh that all labels share.
void smooth(LabelMesh& mesh, int rounds, int threads);

// A surface of marching cubes, in index space: each vertex in one grid edge. It may be open.
template <class Coordinate>
void smooth(Coordinate* vertices, std::size_t vertex_count, const std::int32_t* triangles, std::size_t triangle_count,
            int rounds, int threads);

}  // namespace isocore::labels
