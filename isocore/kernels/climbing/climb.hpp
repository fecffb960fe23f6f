// climb.hpp - Adaptive skeleton climbing: the public function.
// samples: i fastest, at least 2 per axis. Returns vertices in index space, each bit for bit marching cubes' vertex of
// its grid edge, ordered by the edge's lower row (j, k), then axis, then i; triangles ordered by block row and block,
// its boxes before its single cells, counter-clockwise seen from outside. The surface has marching cubes' topology,
// component by component. The same bytes for any number of threads. Throws std::invalid_argument for an axis shorter
// than 2 or a block size that is not 1, 2, 4, 8, 16 or 32, and std::length_error if there are more vertices than an
// int32 can name.
#pragma once

#include "climbing/types.hpp"
#include "common/grid.hpp"

namespace isocore::climbing {

// Instantiated for the eight sample types of volume.py, and for float and double coordinates. ranges: what
// sample_ranges() gave, or null; with it, blocks that the isovalue does not cross are not read.
template <class Sample, class Coordinate>
Mesh<Coordinate> climb(GridView<Sample> samples, const Options& options, const Sample* ranges = nullptr);

}  // namespace isocore::climbing
