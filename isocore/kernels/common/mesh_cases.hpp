// mesh_cases.hpp - Which triangles a cell draws. Triangles name the cell's edges, counter-clockwise seen from
// outside, outside being where the lower values are; number 12 + n is the n-th
// vertex in the middle of a loop, and comes last in its triangles.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "common/cell_loops.hpp"
#include "common/mesh_cells.hpp"

namespace isocore::mesh {

inline constexpr std::size_t kMiddle = 12;

struct TetCase {
    std::uint8_t triangles = 0;
    std::uint8_t middles = 0;
    std::array<std::uint8_t, 6> edges{};
};

namespace derivation {

constexpr std::uint8_t tet_edge(int a, int b) {
    for (std::uint8_t e = 0; e < 6; ++e) {
        const auto& ends = Tet::kShape.ends[e];
        if ((ends[0] == a && ends[1] == b) || (ends[0] == b && ends[1] == a)) return e;
    }
    throw "no such edge";
}

// The other corners, in the order in which they turn counter-clockwise seen from corner a.
constexpr std::array<int, 3> around(int a) {
    constexpr std::array<std::array<int, 3>, 4> kSeen{{{1, 3, 2}, {0, 2, 3}, {0, 3, 1}, {0, 1, 2}}};
    return kSeen[static_cast<unsigned>(a)];
}

constexpr TetCase tet_case(unsigned signs) {
    TetCase out;
    unsigned filled = 0;
    const auto draw = [&](std::uint8_t a, std::uint8_t b, std::uint8_t c) {
        for (const auto edge : {a, b, c}) out.edges[filled++] = edge;
        ++out.triangles;
    };
    const int inside = std::popcount(signs);
    if (inside == 1 || inside == 3) {
        // One corner apart: its three edges. Seen from it they turn counter-clockwise, which is right if it is outside.
        const int apart = std::countr_zero(inside == 1 ? signs : signs ^ 15u);
        const auto ring = around(apart);
        const auto edge = [&](unsigned n) { return tet_edge(apart, ring[n]); };
        inside == 3 ? draw(edge(0), edge(1), edge(2)) : draw(edge(0), edge(2), edge(1));
    } else if (inside == 2) {
        // Two and two: a quadrilateral, cut between two opposite edges of the tetrahedron.
        const int a = std::countr_zero(signs), b = std::countr_zero(signs & (signs - 1));
        auto ring = around(a);
        while (ring[0] != b) ring = {ring[1], ring[2], ring[0]};
        const int c = ring[1], d = ring[2];
        draw(tet_edge(a, c), tet_edge(b, c), tet_edge(b, d));
        draw(tet_edge(a, c), tet_edge(b, d), tet_edge(a, d));
    }
    return out;
}

}  // namespace derivation

inline constexpr std::array<TetCase, 16> kTetCases = [] {
    std::array<TetCase, 16> cases{};
    for (unsigned signs = 0; signs < 16; ++signs) cases[signs] = derivation::tet_case(signs);
    return cases;
}();

using HexCase = cell_loops::CaseOf<12>;
inline constexpr cell_loops::TableOf<HexCase> kHexCases =
    cell_loops::derivation::derive<HexCase>(cell_loops::FaceDiagonals::none);

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
