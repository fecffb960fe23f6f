// late_mesh.hpp - Brings the mesh up to date after boxes were halved late: vertices and triangles are in an order that
// the input alone decides, so late ones go in between, and what lies behind moves.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "climbing/boxes/bars.hpp"
#include "climbing/error/splitting.hpp"
#include "common/array.hpp"

namespace isocore::climbing {

// Moves vertices (x, y, z of each) apart so that there is room for late ones, which are ordered and have their numbers
// in the new order. Their places are left for the caller to write. Instantiated for float and double.
template <class Coordinate>
void make_room(const std::vector<LateVertex>& late, Array<Coordinate>& vertices);

// Replaces the numbers that vertices had before make_room() by those that they have after it.
void renumber(const std::vector<LateVertex>& late, std::span<std::int32_t> vertices);

// The triangles of the bars that were drawn anew, by bar; nothing for the others.
using Redrawn = std::vector<std::optional<std::vector<std::int32_t>>>;

// Moves the triangles of each bar from triangle `before[n]` to triangle bars.bars[n].first_triangle, and puts those
// that were redrawn into their places. `triangles` has room for both.
void move_triangles(const std::vector<std::size_t>& before, const Redrawn& redrawn, const Bars& bars,
                    Array<std::int32_t>& triangles);

}  // namespace isocore::climbing
