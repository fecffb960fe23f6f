// ambiguities.hpp - The places where a surface could have been drawn in two ways: cell faces whose corners are
// alternately inside and outside. Each face is listed once, ordered by the row (j, k) of its lowest sample, by the axis
// across it, then by i. Faces with a value that is not finite are left out: nothing was interpolated there.
#pragma once

#include "common/array.hpp"
#include "common/grid.hpp"

namespace isocore::ambiguities {

struct Found {
    Array<double> places;  // x, y, z in index space of each face's saddle
    // Each saddle's value minus the isovalue (turned over with `below`): not below 0 where the inside corners are
    // joined.
    Array<double> distances;
};

// samples: at least 2 per axis. `below`: inside is sample <= isovalue; distances are positive inside then too.
template <class Sample>
Found find(GridView<Sample> samples, double isovalue, bool below, int threads);

}  // namespace isocore::ambiguities
