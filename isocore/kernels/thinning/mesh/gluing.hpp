// gluing.hpp - The mesh glued along its faces only: what M means in the README. Two cells are glued where both, and no
// third, have the same face. An edge or vertex that cells touch without being glued around it counts as several copies.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "common/array.hpp"
#include "common/mesh_cells.hpp"

namespace isocore::thinning {

// A face that more than two cells share is glued nowhere. Cells that name a point twice are glued nowhere either.
struct Oddities {
    std::size_t crowded_faces = 0, collapsed_cells = 0;
    std::array<std::int32_t, 3> crowded_cells{-1, -1, -1};  // of the first such face: the lowest cell ids
    std::int32_t collapsed_cell = -1;                       // the first
};

template <class Cell>
struct Gluing {
    std::size_t cells = 0;
    Array<std::int32_t> corners;  // kCorners point ids per cell
    Array<std::int32_t> twins;    // per face: kFaces * cell + face on its other side, or -1 - number of boundary face
    Array<std::int32_t> copies;   // per corner: its vertex copy
    Array<std::int32_t> edges;    // per edge of a cell: its edge copy
    std::size_t copy_count = 0, edge_count = 0, boundary_faces = 0;
    Array<std::int32_t> shell;  // per boundary face: the lowest face of its connected piece of boundary
    std::size_t shells = 0;
    Oddities oddities;

    std::int32_t neighbour(std::size_t cell, std::size_t face) const {
        const std::int32_t twin = twins[Cell::kFaces * cell + face];
        return twin < 0 ? -1 : twin / static_cast<std::int32_t>(Cell::kFaces);
    }
};

// corners: kCorners point ids per cell, in our order, each below `points`. Linear in the number of cells.
template <class Cell>
Gluing<Cell> glue(Array<std::int32_t> corners, std::size_t points);

}  // namespace isocore::thinning
