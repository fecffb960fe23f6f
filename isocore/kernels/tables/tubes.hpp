// tubes.hpp - Cells that are not only disks: for every case and every two loops that a tube may join, its triangles.
// Derived at compile time, once, in tubes.cpp, which says how, and proved in tests/kernels. 196 tubes, none with a
// vertex of its own.
#pragma once

#include <array>
#include <cstdint>

#include "tables/cell_loops.hpp"

namespace isocore::marching_cubes {

struct Tube {
    std::uint8_t one = 0, other = 0;  // the groups that meet, a bit per corner
    cell_loops::CaseOf<12> drawn;     // the whole cell; `loops` is the number of loops on the cell's boundary
};

inline constexpr int kTubes = 196;

struct TubeTable {
    std::array<std::uint16_t, cell_loops::kCases + 1> first{};  // case n has tubes first[n] to first[n + 1] - 1
    std::array<Tube, kTubes> tubes{};
};

extern const TubeTable kTubeTable;

}  // namespace isocore::marching_cubes
