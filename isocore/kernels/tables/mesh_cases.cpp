#include "tables/mesh_cases.hpp"

#include <array>
#include <bit>
#include <cstdint>

#include "tables/derive_loops.hpp"

namespace isocore::mesh {
namespace {

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

constexpr cell_loops::TableOf<HexCase> kDerivedHexCases =
    cell_loops::derivation::derive<HexCase>(cell_loops::derivation::FaceDiagonals::none);

}  // namespace

constinit const std::array<TetCase, 16> kTetCases = [] {
    std::array<TetCase, 16> cases{};
    for (unsigned signs = 0; signs < 16; ++signs) cases[signs] = tet_case(signs);
    return cases;
}();

constinit const cell_loops::TableOf<HexCase> kHexCases = kDerivedHexCases;

}  // namespace isocore::mesh
