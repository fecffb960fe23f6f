// marching_cubes.hpp - Marching cubes on a volume: the public function, and the reference of every report.
// samples: i fastest, at least 2 per axis. Returns vertices in index space, one for every crossed grid edge, ordered
// by the edge's lower row (j, k), then axis, then i; triangles ordered by cell, counter-clockwise seen from outside.
// The surface is a 2-manifold, closed except where it meets the volume's border, and closed there too with `capped`.
// The same bytes for any number of threads. Throws std::invalid_argument if an axis is shorter than 2 and
// std::length_error if there are more vertices than an int32 can name.
#pragma once

#include <cstddef>
#include <cstdint>

#include "common/array.hpp"
#include "common/grid.hpp"

namespace isocore::marching_cubes {

struct Options {
    double isovalue = 0;
    bool below = false;      // inside is sample <= isovalue, for volumes with a negative slope
    bool capped = false;     // treat all beyond the border as outside
    bool trilinear = false;  // a cell's surface has the topology of the trilinear function: tubes, not only disks
    int threads = 1;
};

template <class Coordinate>
struct Mesh {
    Array<Coordinate> vertices;       // x, y, z, x, y, z ...
    Array<std::int32_t> triangles;    // three vertices each
    std::size_t ambiguous_faces = 0;  // decided by the asymptotic decider, counted once per cell they bound
    std::size_t ambiguous_cells = 0;
    std::size_t tubes = 0;  // cells with two loops joined, at most one pair each; only if `trilinear`
};

// Instantiated for the eight sample types of volume.py, and for float and double coordinates.
template <class Sample, class Coordinate>
Mesh<Coordinate> march(GridView<Sample> samples, const Options& options);

}  // namespace isocore::marching_cubes
