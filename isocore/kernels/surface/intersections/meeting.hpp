// meeting.hpp - Do two triangles meet? Exact answers; triangles are closed, so to touch is to meet.
#pragma once

#include <array>

#include "surface/mesh_view.hpp"

namespace isocore::intersections {

using Triangle = std::array<Vec3, 3>;

// Triangles without area (three corners on one line) are no triangles here: they meet nothing.
bool has_area(const Triangle& triangle);

// Triangles that share no corner: do they have any point in common?
bool meet(const Triangle& one, const Triangle& other);

// Triangles that share their first corners: do they have any other point in common?
bool meet_beyond_corner(const Triangle& one, const Triangle& other);

// The same, known in double precision alone: true where they certainly have none, whether or not they have area.
bool surely_apart_beyond_corner(const Triangle& one, const Triangle& other);

// Triangles that share their first two corners, in whichever order: do they have any point off that edge in common?
bool meet_beyond_edge(const Triangle& one, const Triangle& other);

}  // namespace isocore::intersections
