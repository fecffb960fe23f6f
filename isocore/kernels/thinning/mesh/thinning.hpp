// thinning.hpp - Volume thinning and isosurface propagation on a mesh: the public functions.
//
// build: once per field. tets and hexes as in marching_cells.hpp. Linear in the number of cells.
// check_index: once per index that somebody else hands over. Linear in the number of cells.
// propagate: once per isovalue. Visits the cells the isosurface meets and no others, and returns the vertices and the
// triangles a full scan would, in the order of the index's cells: the same bytes for any number of threads.
// walk: the search of propagate alone, to time it apart from the drawing.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "common/array.hpp"
#include "common/mesh_field.hpp"
#include "thinning/mesh/gluing.hpp"
#include "thinning/mesh/records.hpp"
#include "thinning/mesh/scratch.hpp"
#include "thinning/mesh/thinner.hpp"

namespace isocore::thinning {

struct Part {
    Array<std::int32_t> records;   // records.hpp, by cell
    Array<std::int32_t> skeleton;  // cells, by ascending low
    Array<double> low, high;       // of every skeleton cell: it meets the isosurface iff low < isovalue <= high
    std::array<std::size_t, 7> classes{};
    std::size_t extrema = 0;
    Oddities oddities;
};

struct Index {
    Part tets, hexes;
    Array<std::int32_t> points;  // the mesh's id of every point of the index
};

struct Cells {
    const std::int32_t *tets, *hexes;
    std::size_t tet_count, hex_count;
};

template <class Value>
Index build(const mesh::Field<Value>& field, const Cells& cells, Work work);

// An index as it lies in memory or on disk.
struct PartView {
    const std::int32_t *records, *skeleton;
    const double *low, *high;
    std::size_t cells, skeleton_size;
};

struct IndexView {
    PartView tets, hexes;
    const std::int32_t* points;  // the mesh's id of every point of the index
};

// Throws std::invalid_argument unless all that the index names is there, cells are glued both ways, but not where they
// name a point twice, and in the order of their lowest points, and the skeleton is sorted by low. `points` is how many
// there are.
void check_index(const IndexView& index, std::size_t points);

template <class Coordinate>
struct Mesh {
    Array<Coordinate> vertices;     // x, y, z, x, y, z ...
    Array<std::int32_t> triangles;  // three vertices each
    Array<std::int32_t> edges;      // where asked for, the two point ids of each vertex's mesh edge, the lower first
    std::size_t seeds = 0;          // skeleton cells the isosurface meets
    std::size_t visited = 0;        // cells walked, all of which it meets
};

// field: the points and values as the index numbers them. The index must be one that check_index accepts. No two calls
// may share a scratch at a time.
template <class Coordinate, class Value>
Mesh<Coordinate> propagate(const mesh::Field<Value>& field, const IndexView& index, double isovalue, int threads,
                           bool with_edges, Scratch& scratch);

// The cells that propagate would draw, ascending.
struct Visited {
    Array<std::int32_t> tets, hexes;
    std::size_t seeds = 0;
};

template <class Value>
Visited walk(const mesh::Field<Value>& field, const IndexView& index, double isovalue, Scratch& scratch);

}  // namespace isocore::thinning
