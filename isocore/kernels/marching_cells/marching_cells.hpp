// marching_cells.hpp - Marching tetrahedra, and marching cubes on hexahedra: a full scan of all cells of a mesh.
// tets: 4 point ids per cell; hexes: 8, in VTK's order; every id below field.size. Returns one vertex per crossed
// mesh edge, named by its two point ids, and one in the middle of each loop that cannot be cut otherwise; triangles
// ordered by cell, counter-clockwise seen from outside (lower values) whichever way a cell is turned. A triangle with
// two equal vertices (of a cell that names a point twice) is left out. The same bytes for any number of threads.
// Throws std::length_error if there are more vertices than an int32 can name.
#pragma once

#include <cstddef>
#include <cstdint>

#include "common/array.hpp"
#include "common/mesh_field.hpp"

namespace isocore::marching_cells {

struct Cells {
    const std::int32_t *tets, *hexes;
    std::size_t tet_count, hex_count;
};

template <class Coordinate>
struct Mesh {
    Array<Coordinate> vertices;     // x, y, z, x, y, z ...
    Array<std::int32_t> triangles;  // three vertices each
    Array<std::int32_t> edges;      // where asked for, the two point ids of each vertex's mesh edge, the lower first
    std::size_t intersected = 0;    // cells that the isosurface meets
};

// Instantiated for float and double.
template <class Coordinate, class Value>
Mesh<Coordinate> march(const mesh::Field<Value>& field, const Cells& cells, double isovalue, int threads,
                       bool with_edges = false);

}  // namespace isocore::marching_cells
