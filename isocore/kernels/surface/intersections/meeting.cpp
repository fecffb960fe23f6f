// meeting.cpp - Triangles that share no plane meet iff an edge of one meets the other; such an edge is a segment that
// passes through a plane, and is seen from one end to turn around the triangle's sides in one sense only. In one plane
// everything is seen along an axis, in two dimensions. What is far apart is told apart without exact arithmetic.
#include "surface/intersections/meeting.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "surface/intersections/orientation.hpp"

namespace isocore::intersections {
namespace {

// An axis along which a triangle is not seen edge-on; 3 where it has no area.
std::size_t open_axis(const Triangle& t) {
    const Vec3 normal = cross(t[1] - t[0], t[2] - t[0]);
    std::size_t best = 0;
    for (std::size_t axis = 1; axis < 3; ++axis) best = std::abs(normal[axis]) > std::abs(normal[best]) ? axis : best;
    for (std::size_t turn = 0; turn < 3; ++turn) {
        const std::size_t axis = (best + turn) % 3;
        if (line_side(axis, t[0], t[1], t[2]) != 0) return axis;
    }
    return 3;
}

// Is every point of `points` certainly on one side of the triangle's plane?
template <std::size_t count>
bool plane_separates(const Triangle& t, const std::array<Vec3, count>& points) {
    const int first = likely_plane_side(t[0], t[1], t[2], points[0]);
    bool apart = first != 0;
    for (std::size_t n = 1; apart && n < count; ++n) apart = likely_plane_side(t[0], t[1], t[2], points[n]) == first;
    return apart;
}

// Seen along `axis`, does a side of the triangle certainly have all of the triangle on one hand and `points` on the
// other? Then they are apart, whatever lies between the two seen from elsewhere.
template <std::size_t count>
bool side_separates(std::size_t axis, const Triangle& t, const std::array<Vec3, count>& points) {
    const int turn = likely_line_side(axis, t[0], t[1], t[2]);
    if (turn == 0) return false;
    for (std::size_t n = 0; n < 3; ++n) {
        const Vec3 &from = t[n], &to = t[(n + 1) % 3];
        const auto beyond = [&](const Vec3& point) { return likely_line_side(axis, from, to, point) == -turn; };
        if (std::all_of(points.begin(), points.end(), beyond)) return true;
    }
    return false;
}

// In one plane, seen along `axis`: is a point inside a triangle or on its border?
bool contains(std::size_t axis, const Triangle& t, const Vec3& point) {
    const int a = line_side(axis, t[0], t[1], point), b = line_side(axis, t[1], t[2], point),
              c = line_side(axis, t[2], t[0], point);
    return !((a < 0 || b < 0 || c < 0) && (a > 0 || b > 0 || c > 0));
}

// Of a point on the line through two others: does it lie between them?
bool lies_between(std::size_t axis, const Vec3& from, const Vec3& to, const Vec3& point) {
    for (std::size_t other = 0; other < 3; ++other) {
        if (other == axis) continue;
        const auto [low, high] = std::minmax(from[other], to[other]);
        if (point[other] < low || point[other] > high) return false;
    }
    return true;
}

bool segments_meet(std::size_t axis, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const int ac = line_side(axis, a, b, c), ad = line_side(axis, a, b, d);
    const int ca = line_side(axis, c, d, a), cb = line_side(axis, c, d, b);
    if (ac * ad < 0 && ca * cb < 0) return true;
    return (ac == 0 && lies_between(axis, a, b, c)) || (ad == 0 && lies_between(axis, a, b, d)) ||
           (ca == 0 && lies_between(axis, c, d, a)) || (cb == 0 && lies_between(axis, c, d, b));
}

bool meets_in_plane(std::size_t axis, const Triangle& t, const Vec3& from, const Vec3& to) {
    if (contains(axis, t, from)) return true;
    for (std::size_t n = 0; n < 3; ++n) {
        if (segments_meet(axis, t[n], t[(n + 1) % 3], from, to)) return true;
    }
    return false;
}

// Does a segment meet a triangle? from_side, to_side: of the triangle's plane.
bool segment_meets(const Triangle& t, const Vec3& from, const Vec3& to, int from_side, int to_side) {
    if (from_side * to_side > 0) return false;
    if (from_side == 0 && to_side == 0) return meets_in_plane(open_axis(t), t, from, to);
    int sense = 0;
    for (std::size_t n = 0; n < 3; ++n) {
        const int side = plane_side(from, to, t[n], t[(n + 1) % 3]);
        if (side == 0) continue;
        if (side == -sense) return false;
        sense = side;
    }
    return true;
}

bool segment_meets(const Triangle& t, const Vec3& from, const Vec3& to) {
    const std::array<Vec3, 2> ends{from, to};
    if (plane_separates(t, ends)) return false;
    const std::size_t axis = open_axis(t);
    if (side_separates(axis, t, ends)) return false;
    return segment_meets(t, from, to, plane_side(t[0], t[1], t[2], from), plane_side(t[0], t[1], t[2], to));
}

// Does a side of `one` meet the triangle `other`?
bool side_meets(const Triangle& one, const Triangle& other) {
    std::array<int, 3> sides;
    for (std::size_t n = 0; n < 3; ++n) sides[n] = plane_side(other[0], other[1], other[2], one[n]);
    for (std::size_t n = 0; n < 3; ++n) {
        const std::size_t next = (n + 1) % 3;
        if (segment_meets(other, one[n], one[next], sides[n], sides[next])) return true;
    }
    return false;
}

}  // namespace

bool has_area(const Triangle& triangle) { return open_axis(triangle) < 3; }

bool meet(const Triangle& one, const Triangle& other) {
    if (plane_separates(one, other) || plane_separates(other, one)) return false;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (side_separates(axis, one, other) || side_separates(axis, other, one)) return false;
    }
    // In one plane a triangle may lie within the other, and its sides meet it then, too: they are inside.
    return side_meets(one, other) || side_meets(other, one);
}

bool surely_apart_beyond_corner(const Triangle& one, const Triangle& other) {
    return plane_separates(one, std::array<Vec3, 2>{other[1], other[2]}) ||
           plane_separates(other, std::array<Vec3, 2>{one[1], one[2]});
}

bool meet_beyond_corner(const Triangle& one, const Triangle& other) {
    return segment_meets(other, one[1], one[2]) || segment_meets(one, other[1], other[2]);
}

bool meet_beyond_edge(const Triangle& one, const Triangle& other) {
    if (plane_side(one[0], one[1], one[2], other[2]) != 0) return false;
    const std::size_t axis = open_axis(one);
    return line_side(axis, one[0], one[1], one[2]) == line_side(axis, one[0], one[1], other[2]);
}

}  // namespace isocore::intersections
