// gluing.hpp - The mesh glued along its faces: two cells are glued where both, and no third, have the same face. An
// edge that cells touch without being glued around it counts as several copies (docs/proofs/thinning.md, section 2).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/array.hpp"
#include "common/mesh_field.hpp"
#include "thinning/mesh/ordering.hpp"
#include "thinning/mesh/records.hpp"

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
    Array<std::int32_t> records;          // records.hpp; at the boundary, a twin is -1 - number of the boundary face
    Array<std::int32_t> original;         // by cell: the mesh's
    Array<std::int32_t> boundary;         // by number: kFaces * cell + face
    std::vector<std::int32_t> collapsed;  // the cells that name a point twice, ascending
    Oddities oddities;                    // in the mesh's numbers

    const std::int32_t* record(std::size_t cell) const { return records.data() + kRecord<Cell> * cell; }
};

// cells: kCorners point ids per cell, in VTK's order, each below field.size. Cells are ordered by their lowest point in
// the new order, then as the mesh has them. Linear in the number of cells; the same for any number of threads.
template <class Cell, class Value>
Gluing<Cell> glue(const mesh::Field<Value>& field, const std::int32_t* cells, std::size_t count,
                  const PointOrder& points, int threads);

}  // namespace isocore::thinning
