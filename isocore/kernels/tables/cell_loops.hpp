// cell_loops.hpp - How the surface crosses one cell: a table of cases, by corner signs and face decisions. It is
// derived at compile time, once, in cell_loops.cpp, and proved in tests/kernels.
//
// A case is the eight corner signs and, for each face with alternating corners, whether its inside corners are
// joined: 656 cases, 1,026 loops of 3 to 12 edges. derive_loops.hpp says how the loops are found and cut into
// triangles.
#pragma once

#include <array>
#include <cstdint>

namespace isocore::cell_loops {

inline constexpr int kMaxTriangles = 10;
inline constexpr int kCases = 656;

// What is drawn in a cell. Triangles name the cell's edges, numbered as in cube.hpp.
template <int max_triangles>
struct CaseOf {
    std::uint8_t triangles = 0;
    std::uint8_t loops = 0;
    std::uint8_t middles = 0;                             // loops that are cut from a vertex in their middle
    std::array<std::uint8_t, 3 * max_triangles> edges{};  // three per triangle; 12 + n is the n-th middle, always last
};
using Case = CaseOf<kMaxTriangles>;

// What eight corner signs lead to: case number `first` plus the decisions of the ambiguous faces. Bit n of the
// decisions is 1 if the inside corners of the n-th ambiguous face, in ascending order, are joined.
struct Corners {
    std::uint16_t first = 0;
    std::uint8_t ambiguous = 0;  // the faces with alternating corners, a bit each
};

// `corners` is indexed by the corner signs, bit c for corner c.
template <class AnyCase>
struct TableOf {
    std::array<Corners, 256> corners{};
    std::array<AnyCase, kCases> cases{};
};

using CaseTable = TableOf<Case>;
extern const CaseTable kTable;

}  // namespace isocore::cell_loops
