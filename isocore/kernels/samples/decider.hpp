// decider.hpp - The decisions that a cell with alternating faces needs, taken from its samples by the asymptotic
// decider (crossing.hpp).
#pragma once

#include <bit>
#include <cstddef>

#include "common/crossing.hpp"
#include "common/cube.hpp"
#include "common/grid.hpp"
#include "tables/cell_loops.hpp"

namespace isocore {

// Are the inside corners of an alternating face joined? `corners` are the cell's corner signs; `cell` is its lowest
// sample in the grid of signs, which has `pad` layers around the samples; faces and corners are numbered as in
// cube.hpp.
template <class Sample>
bool face_joined(const GridView<Sample>& samples, std::size_t pad, double isovalue, unsigned corners, const Dims& cell,
                 int face) {
    const auto ring = cube::face_ring(face);
    const auto value = [&](std::size_t n) {
        const auto c = static_cast<std::size_t>(ring[n]);
        return static_cast<double>(
            samples.at(cell[0] + (c & 1) - pad, cell[1] + (c >> 1 & 1) - pad, cell[2] + (c >> 2) - pad));
    };
    const std::size_t in = corners >> ring[0] & 1 ? 0 : 1;
    return inside_corners_joined(value(in), value(in + 2), value(1 - in), value(3 - in), isovalue);
}

// The decisions of all alternating faces, one bit each in ascending order of faces: bit n is that of the n-th bit of
// cell_loops::Corners::ambiguous. A case's number is Corners::first plus this.
template <class Sample>
unsigned decide_faces(const GridView<Sample>& samples, std::size_t pad, double isovalue, unsigned corners,
                      const Dims& cell) {
    unsigned packed = 0, bit = 0;
    for (unsigned left = cell_loops::kTable.corners[corners].ambiguous; left != 0; left &= left - 1, ++bit) {
        packed |= static_cast<unsigned>(face_joined(samples, pad, isovalue, corners, cell, std::countr_zero(left)))
                  << bit;
    }
    return packed;
}

}  // namespace isocore
