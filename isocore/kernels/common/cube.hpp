// cube.hpp - The names of a cube's corners, edges and faces. Corner c lies at (c & 1, c >> 1 & 1, c >> 2 & 1).
// Edge e runs along axis e / 4; its bits e & 1 and e >> 1 & 1 are its place along the other two axes, lower axis
// first. Face f has axis f / 2 and lies on the low (f even) or high side.
#pragma once

#include <array>
#include <cstdint>

namespace isocore::cube {

// The two axes other than `axis`, ascending.
constexpr std::array<int, 2> other_axes(int axis) { return {axis == 0 ? 1 : 0, axis == 2 ? 1 : 2}; }

// The corner of edge e that is lower in index order; the other one is that plus 1 << axis.
constexpr int low_corner(int edge) {
    const auto other = other_axes(edge / 4);
    return (edge & 1) << other[0] | (edge >> 1 & 1) << other[1];
}
constexpr int high_corner(int edge) { return low_corner(edge) | 1 << (edge / 4); }

constexpr int edge_between(int a, int b) {
    const int axis = (a ^ b) == 1 ? 0 : (a ^ b) == 2 ? 1 : 2;
    const auto other = other_axes(axis);
    return 4 * axis + (a >> other[0] & 1) + 2 * (a >> other[1] & 1);
}

// The corners of a face, counter-clockwise seen from outside the cube.
constexpr std::array<int, 4> face_ring(int face) {
    const int axis = face / 2, p = (axis + 1) % 3, q = (axis + 2) % 3, base = (face & 1) << axis;
    if (face & 1) return {base, base | 1 << p, base | 1 << p | 1 << q, base | 1 << q};
    return {base, base | 1 << q, base | 1 << p | 1 << q, base | 1 << p};
}

constexpr bool edge_on_face(int edge, int face) {
    const int axis = face / 2;
    return edge / 4 != axis && (low_corner(edge) >> axis & 1) == (face & 1);
}

// The face two edges share, or -1.
constexpr int shared_face(int a, int b) {
    for (int face = 0; face < 6; ++face) {
        if (edge_on_face(a, face) && edge_on_face(b, face)) return face;
    }
    return -1;
}

// Are the corners of a face alternately inside and outside?
constexpr bool alternates(unsigned corners, int face) {
    const auto ring = face_ring(face);
    const auto in = [&](int n) { return corners >> ring[static_cast<unsigned>(n)] & 1; };
    return in(0) == in(2) && in(1) == in(3) && in(0) != in(1);
}

}  // namespace isocore::cube
