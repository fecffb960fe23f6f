// sheets.hpp - The mesh that all labels share as a mesh of sheets, one for each pair of neighbours.
#pragma once

#include <cstddef>
#include <cstdint>

#include "common/array.hpp"
#include "common/narrow_array.hpp"
#include "labels/label_mesh.hpp"

namespace isocore::labels {

struct Sheets {
    Array<std::uint32_t> pairs;      // two ranks each, the higher first, in ascending order
    NarrowArray of_triangles;        // of each triangle: the number of its pair
    Array<std::uint32_t> vertices;   // of each sheet: how many it has, those on its border included
    Array<std::uint32_t> triangles;  // of each sheet: how many it has
};

// Takes the sides and the curves from the mesh: a sheet's pair says as much as the sides of its triangles.
Sheets take_sheets(LabelMesh& mesh);

// Takes fewer triangles in the place of all, and gives them their sides. vertices, triangles: as in the mesh. kept,
// left: of each vertex and of each triangle, its number so far.
void replace(LabelMesh& mesh, const Sheets& sheets, Array<float> vertices, Array<std::int32_t> triangles,
             const Array<std::int32_t>& kept, const Array<std::int32_t>& left);

}  // namespace isocore::labels
