// extrema_graph.hpp - The structure volume thinning replaced: T. Itoh, K. Koyamada, "Automatic Isosurface Propagation
// Using an Extrema Graph and Sorted Boundary Cell Lists", IEEE TVCG 1(4), 1995. For the paper's tables only. twins:
// `faces` per cell, faces * cell + face across, or negative at the boundary. at_extremum: 1 for every cell with a
// corner that is a local minimum or maximum. Returns the cells to register, ascending: those on the paths that join the
// extrema, and those at the boundary.
#pragma once

#include <cstddef>
#include <cstdint>

#include "common/array.hpp"

namespace isocore::rivals {

Array<std::int32_t> extrema_graph(const std::int32_t* twins, std::size_t stride, std::size_t cells, std::size_t faces,
                                  const std::uint8_t* at_extremum);

}  // namespace isocore::rivals
