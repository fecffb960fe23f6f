// meeting.hpp - Do two triangles of a mesh meet where they should not? Exact, as predicates.hpp is.
#pragma once

#include <array>
#include <cstdint>

#include "common/predicates.hpp"

namespace isocore {

// A triangle of a mesh: its corners by number and by place. Corners of one number have one place.
struct Corners3 {
    std::array<std::int32_t, 3> numbers;
    std::array<Point, 3> places;
};

// Do two triangles meet anywhere but in the corners, or the side, that they have in common by number? Two that touch
// meet, two of the same three corners do, and so do two that share a side and are folded onto each other. Both have an
// area.
bool meet(const Corners3& one, const Corners3& other);

}  // namespace isocore
