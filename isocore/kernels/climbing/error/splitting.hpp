// splitting.hpp - What happens to the few boxes that turn out, once they are measured, to break the error bound: they
// are halved until their parts hold disks again, and the crossings on the parts' edges become vertices. late_mesh.hpp
// then brings the mesh up to date.
#pragma once

#include <cstddef>
#include <vector>

#include "climbing/boxes/bars.hpp"
#include "climbing/crossings/layout.hpp"
#include "climbing/high_rice.hpp"
#include "samples/signs.hpp"

namespace isocore::climbing {

// A highrice that a broken box was halved to, and the origin of its block.
struct LateHighRice {
    Dims origin;
    HighRice box;
};

// Halves the boxes named in bar.broken of each bar: writes the bars' halvings anew, empties the lists, and marks as
// stale every bar that a part of such a box touches. Returns the parts.
std::vector<LateHighRice> split_broken(const SignGrid& signs, Bars& bars);

// A crossing that became a vertex late: its number, its grid edge by axis and lower sample, and, once
// layout.number() has been called again, the number of the vertex.
struct LateVertex {
    std::size_t crossing;
    int axis;
    Dims at;
    std::size_t vertex = 0;
};

// Keeps the crossings on the edges of late boxes. Returns those that were not kept before, by crossing.
std::vector<LateVertex> keep_late(const SignGrid& signs, const std::vector<LateHighRice>& late, int block_size,
                                  Layout& layout);

}  // namespace isocore::climbing
