// meeting.cpp - Two triangles meet iff a side of one meets the other, so everything comes down to where a side's ends
// lie beside a plane, and how a line passes a triangle's sides.
#include "common/meeting.hpp"

#include <algorithm>
#include <cstddef>
#include <initializer_list>
#include <utility>

namespace isocore {
namespace {

using Places = std::array<Point, 3>;

// A triangle seen along an axis, such that it still has an area: which way it turns there.
struct View {
    std::size_t axis;
    int turns;
};

View view_of(const Places& t) {
    for (std::size_t axis = 0; axis < 2; ++axis) {
        if (const int turns = turn(t[0], t[1], t[2], axis); turns != 0) return {axis, turns};
    }
    return {2, turn(t[0], t[1], t[2], 2)};
}

// Do points in the plane of t all lie beyond the same side of it? Of two convex outlines in a plane that have no point
// in common, one lies beyond a side of the other.
bool are_beyond_a_side(std::initializer_list<Point> points, const Places& t, const View& view) {
    for (std::size_t n = 0; n < 3; ++n) {
        const auto is_beyond = [&](const Point& p) {
            return turn(t[n], t[(n + 1) % 3], p, view.axis) * view.turns < 0;
        };
        if (std::all_of(points.begin(), points.end(), is_beyond)) return true;
    }
    return false;
}

// Does the segment p q, in the plane of t, meet t?
bool meets_in_plane(const Point& p, const Point& q, const Places& t) {
    const View view = view_of(t);
    if (are_beyond_a_side({p, q}, t, view)) return false;
    const int one = turn(p, q, t[0], view.axis);
    return one == 0 || turn(p, q, t[1], view.axis) != one || turn(p, q, t[2], view.axis) != one;
}

// Do two triangles of one plane meet?
bool meet_in_plane(const Places& one, const Places& other) {
    const View view = view_of(one);
    return !are_beyond_a_side({other[0], other[1], other[2]}, one, view) &&
           !are_beyond_a_side({one[0], one[1], one[2]}, other,
                              {view.axis, turn(other[0], other[1], other[2], view.axis)});
}

// Does the segment p q meet t? side_p, side_q: of t's plane.
bool meets(const Point& p, const Point& q, int side_p, int side_q, const Places& t) {
    if (side_p * side_q > 0) return false;
    if (side_p == 0 && side_q == 0) return meets_in_plane(p, q, t);
    const int one = side_of_plane(p, q, t[0], t[1]), two = side_of_plane(p, q, t[1], t[2]);
    if (one * two < 0) return false;
    const int three = side_of_plane(p, q, t[2], t[0]);
    return one * three >= 0 && two * three >= 0;
}

bool meets(const Point& p, const Point& q, const Places& t) {
    return meets(p, q, side_of_plane(t[0], t[1], t[2], p), side_of_plane(t[0], t[1], t[2], q), t);
}

// Two triangles that have no corner in common.
bool strangers_meet(const Places& one, const Places& other) {
    const auto sides = [](const Places& of, const Places& t) {
        return std::array{side_of_plane(t[0], t[1], t[2], of[0]), side_of_plane(t[0], t[1], t[2], of[1]),
                          side_of_plane(t[0], t[1], t[2], of[2])};
    };
    const auto apart = [](const std::array<int, 3>& s) { return s[0] != 0 && s[0] == s[1] && s[1] == s[2]; };
    const auto of_one = sides(one, other);
    if (apart(of_one)) return false;
    const auto of_other = sides(other, one);
    if (apart(of_other)) return false;
    if (of_one == std::array{0, 0, 0} && of_other == of_one) return meet_in_plane(one, other);
    for (std::size_t n = 0; n < 3; ++n) {
        const std::size_t m = (n + 1) % 3;
        if (meets(one[n], one[m], of_one[n], of_one[m], other)) return true;
        if (meets(other[n], other[m], of_other[n], of_other[m], one)) return true;
    }
    return false;
}

// Two that share the side from `from` to `to`, and have one corner each besides.
bool folded(const Point& from, const Point& to, const Point& one, const Point& other) {
    if (side_of_plane(from, to, one, other) != 0) return false;
    const View view = view_of({from, to, one});
    return view.turns * turn(from, to, other, view.axis) >= 0;
}

}  // namespace

bool meet(const Corners3& one, const Corners3& other) {
    std::array<std::size_t, 3> mine{}, theirs{};  // the corners in common
    std::size_t shared = 0;
    for (std::size_t n = 0; n < 3; ++n) {
        for (std::size_t m = 0; m < 3; ++m) {
            if (one.numbers[n] != other.numbers[m]) continue;
            mine[shared] = n;
            theirs[shared++] = m;
            break;
        }
    }
    if (shared == 0) return strangers_meet(one.places, other.places);
    if (shared == 3) return true;
    if (shared == 2) {
        const std::size_t apex = 3 - mine[0] - mine[1], other_apex = 3 - theirs[0] - theirs[1];
        return folded(one.places[mine[0]], one.places[mine[1]], one.places[apex], other.places[other_apex]);
    }
    const auto beyond = [](const Corners3& t, std::size_t n) {
        return std::pair<const Point&, const Point&>{t.places[(n + 1) % 3], t.places[(n + 2) % 3]};
    };
    const auto [a, b] = beyond(one, mine[0]);
    const auto [c, d] = beyond(other, theirs[0]);
    return meets(a, b, other.places) || meets(c, d, one.places);
}

}  // namespace isocore
