// mesh_cases.hpp - Which triangles a cell of a mesh draws, by tables that are derived at compile time, once, in
// mesh_cases.cpp. Triangles name the cell's edges, counter-clockwise seen from outside, outside being where the lower
// values are; number 12 + n is the n-th vertex in the middle of a loop, and comes last in its triangles.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "common/crossing.hpp"
#include "common/cube.hpp"
#include "common/mesh_cells.hpp"
#include "tables/cell_loops.hpp"

namespace isocore::mesh {

inline constexpr std::size_t kMiddle = 12;

struct TetCase {
    std::uint8_t triangles = 0;
    std::uint8_t middles = 0;
    std::array<std::uint8_t, 6> edges{};
};

extern const std::array<TetCase, 16> kTetCases;  // by corner signs

using HexCase = cell_loops::CaseOf<12>;
extern const cell_loops::TableOf<HexCase> kHexCases;

// The case of a tetrahedron needs its signs only.
template <class Values>
const TetCase& drawn(Tet, Mask signs, const Values&, double) {
    return kTetCases[signs];
}

// The case of a hexahedron also needs values(corner), where a face is ambiguous.
template <class Values>
const HexCase& drawn(Hex, Mask signs, const Values& values, double isovalue) {
    const cell_loops::Corners& entry = kHexCases.corners[signs];
    unsigned packed = 0, bit = 0;
    for (unsigned left = entry.ambiguous; left != 0; left &= left - 1, ++bit) {
        const auto ring = cube::face_ring(std::countr_zero(left));
        const auto value = [&](unsigned n) { return values(static_cast<std::size_t>(ring[n])); };
        const unsigned in = signs >> ring[0] & 1 ? 0 : 1;
        packed |= static_cast<unsigned>(
                      inside_corners_joined(value(in), value(in + 2), value(1 - in), value(3 - in), isovalue))
                  << bit;
    }
    return kHexCases.cases[entry.first + packed];
}

// Writes the vertices in the middle of a cell's loops: the mean of a loop's vertices, which position(edge) tells.
template <class AnyCase, class Position, class Coordinate>
void write_middles(const AnyCase& drawn, const Position& position, Coordinate* out) {
    for (std::size_t middle = 0; middle < drawn.middles; ++middle, out += 3) {
        std::array<double, 3> sum{};
        int corners = 0;
        for (std::size_t n = 0; n < 3u * drawn.triangles; n += 3) {
            if (drawn.edges[n + 2] != kMiddle + middle) continue;
            const Coordinate* corner = position(drawn.edges[n]);
            for (std::size_t axis = 0; axis < 3; ++axis) sum[axis] += static_cast<double>(corner[axis]);
            ++corners;
        }
        for (std::size_t axis = 0; axis < 3; ++axis) out[axis] = static_cast<Coordinate>(sum[axis] / corners);
    }
}

}  // namespace isocore::mesh
