// climb.hpp - Adaptive skeleton climbing: the public function.
#pragma once

#include "climbing/types.hpp"
#include "common/grid.hpp"

namespace isocore::climbing {

// The isosurface of a volume.
//
// samples: x fastest, at least 2 along each axis. ranges: what sample_ranges() gave for them, or null; with it, blocks
// that the isovalue does not cross are not read. Instantiated for the eight sample types of volume.py, and for float
// and double coordinates.
//
// Vertices are in index space, each bit for bit marching cubes' vertex of its grid edge, ordered by the edge's lower
// row (j, k), then axis, then i. Triangles are counter-clockwise seen from outside, ordered by bar (a row of blocks)
// and block, and in a block the boxes of several cells before the single cells. The surface has marching cubes'
// topology, component by component. All bytes are the same for any number of threads.
//
// slopes: if given, loops are cut into triangles of least area and least tilt against what it tells, else of least
// area.
//
// Throws std::invalid_argument for an axis shorter than 2 or a block size that is not 1, 2, 4, 8, 16 or 32, and
// std::length_error if there are more vertices than an int32 can number.
template <class Sample, class Coordinate>
Mesh<Coordinate> climb(GridView<Sample> samples, const Options& options, const Sample* ranges = nullptr,
                       const Slopes<Coordinate>& slopes = {});

}  // namespace isocore::climbing
