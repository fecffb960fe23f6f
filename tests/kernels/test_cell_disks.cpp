// The disks of label maps: every one of the cells that can occur, proved. Cells meet only in the lines on their faces,
// so what holds for each cell holds for every volume.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

#include "check.hpp"
#include "common/cube.hpp"
#include "labels/cell_disks.hpp"

namespace {

using namespace isocore;
using namespace isocore::labels;
using Point = std::array<double, 3>;

// Calls visit(ranks) once for every key that corners can have: all partitions of eight corners, with every order of the
// labels that alternate on some face.
template <class Visit>
std::size_t for_each_key(const Visit& visit) {
    std::set<std::uint32_t> keys;
    CornerRanks part{};
    const auto with_orders = [&](std::uint32_t labels) {
        std::set<std::uint32_t> alternating;
        for (int face = 0; face < 6; ++face) {
            const auto ring = cube::face_ring(face);
            const auto label = [&](std::size_t n) { return part[static_cast<std::size_t>(ring[n])]; };
            if (label(0) == label(2) && label(1) == label(3) && label(0) != label(1)) {
                alternating.insert({label(0), label(1)});
            }
        }
        std::vector<std::uint32_t> order(alternating.begin(), alternating.end());
        do {
            CornerRanks ranks;
            for (std::size_t n = 0; n < 8; ++n) {
                const auto found = std::find(order.begin(), order.end(), part[n]);
                ranks[n] = found == order.end() ? labels + part[n] : static_cast<std::uint32_t>(found - order.begin());
            }
            if (keys.insert(disks_key(ranks)).second) visit(ranks);
        } while (std::next_permutation(order.begin(), order.end()));
    };
    const auto fill = [&](auto&& self, std::size_t corner, std::uint32_t labels) -> void {
        if (corner == 8) return with_orders(labels);
        for (part[corner] = 0; part[corner] <= labels; ++part[corner]) {
            const std::uint32_t label = part[corner];
            self(self, corner + 1, std::max(labels, label + 1));
            part[corner] = label;
        }
    };
    fill(fill, 1, 1);
    return keys.size();
}

Point point(std::uint8_t place) {
    Point at{1, 1, 1};
    if (place < kFirstFace) {
        for (int axis = 0; axis < 3; ++axis) {
            if (axis != place / 4) at[static_cast<std::size_t>(axis)] = 2 * (cube::low_corner(place) >> axis & 1);
        }
    } else if (place < kMiddle) {
        at[static_cast<std::size_t>((place - kFirstFace) / 2)] = 2 * ((place - kFirstFace) % 2);
    }
    return at;
}

Point minus(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
double dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Point cross(const Point& a, const Point& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

using Triangle = std::array<Point, 3>;

Triangle triangle(const CellTriangle& drawn) {
    return {point(drawn.places[0]), point(drawn.places[1]), point(drawn.places[2])};
}

Point normal(const Triangle& t) { return cross(minus(t[1], t[0]), minus(t[2], t[0])); }

// Coordinates are 0, 1 and 2, so whatever is not zero is far above this.
constexpr double kZero = 1e-9;

// The part of a convex polygon (or line, or point) where a linear function of its corners is not negative.
template <class Height>
std::vector<Point> clipped(const std::vector<Point>& polygon, const Height& height) {
    std::vector<Point> kept;
    for (std::size_t n = 0; n < polygon.size(); ++n) {
        const Point &a = polygon[n], &b = polygon[(n + 1) % polygon.size()];
        const double ha = height(a), hb = height(b);
        if (ha > -kZero) kept.push_back(a);
        if ((ha < -kZero && hb > kZero) || (ha > kZero && hb < -kZero)) {
            const double t = ha / (ha - hb);
            kept.push_back({a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])});
        }
    }
    return kept;
}

// The corners of what two triangles have in common.
std::vector<Point> common_part(const Triangle& one, const Triangle& other) {
    std::vector<Point> polygon(one.begin(), one.end());
    const Point up = normal(other);
    polygon = clipped(polygon, [&](const Point& p) { return dot(up, minus(p, other[0])); });
    polygon = clipped(polygon, [&](const Point& p) { return -dot(up, minus(p, other[0])); });
    for (std::size_t n = 0; n < 3; ++n) {
        const Point inwards = cross(up, minus(other[(n + 1) % 3], other[n]));
        polygon = clipped(polygon, [&](const Point& p) { return dot(inwards, minus(p, other[n])); });
    }
    return polygon;
}

bool between(const Point& p, const Point& a, const Point& b) {
    const Point along = minus(b, a), from = minus(p, a), off = cross(along, from);
    const double t = dot(along, from);
    return dot(off, off) < kZero && t > -kZero && t < dot(along, along) + kZero;
}

void two_triangles_meet_only_in_what_they_share(const CellTriangle& one, const CellTriangle& other) {
    std::vector<std::uint8_t> shared;
    for (const auto place : one.places) {
        if (std::find(other.places.begin(), other.places.end(), place) != other.places.end()) shared.push_back(place);
    }
    CHECK(shared.size() < 3);
    for (const Point& p : common_part(triangle(one), triangle(other))) {
        CHECK(!shared.empty());
        CHECK(between(p, point(shared.front()), point(shared.back())));
    }
}

bool in_one_face(const CellTriangle& drawn) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for (const double side : {0.0, 2.0}) {
            const Triangle t = triangle(drawn);
            if (t[0][axis] == side && t[1][axis] == side && t[2][axis] == side) return true;
        }
    }
    return false;
}

// Per label, the directed sides of its triangles that no other triangle of it runs the other way: they lie in faces.
void sides_inside_the_cell_cancel_for_every_label(const CornerRanks& ranks, const CellDisks& disks) {
    std::map<std::uint32_t, std::map<std::pair<int, int>, int>> sides;
    for (const CellTriangle& t : disks.triangles) {
        CHECK(ranks[t.behind] != ranks[t.ahead]);
        for (std::size_t n = 0; n < 3; ++n) {
            const int a = t.places[n], b = t.places[(n + 1) % 3];
            ++sides[ranks[t.behind]][{a, b}];
            ++sides[ranks[t.ahead]][{b, a}];
        }
    }
    for (const auto& [label, counts] : sides) {
        for (const auto& [side, count] : counts) {
            const auto back = counts.find({side.second, side.first});
            const int reverse = back == counts.end() ? 0 : back->second;
            const Point a = point(static_cast<std::uint8_t>(side.first)),
                        b = point(static_cast<std::uint8_t>(side.second));
            bool in_face = false;
            for (std::size_t axis = 0; axis < 3; ++axis) in_face |= a[axis] == b[axis] && a[axis] != 1;
            CHECK(in_face ? count == 1 && reverse == 0 : count == reverse);
        }
    }
}

void every_cell_is_sound() {
    std::size_t triangles = 0, most = 0;
    const std::size_t keys = for_each_key([&](const CornerRanks& ranks) {
        const CellDisks disks = derive_disks(ranks);
        sides_inside_the_cell_cancel_for_every_label(ranks, disks);
        for (std::size_t n = 0; n < disks.triangles.size(); ++n) {
            CHECK(dot(normal(triangle(disks.triangles[n])), normal(triangle(disks.triangles[n]))) > kZero);
            CHECK(!in_one_face(disks.triangles[n]));
            for (std::size_t m = 0; m < n; ++m) {
                two_triangles_meet_only_in_what_they_share(disks.triangles[n], disks.triangles[m]);
            }
        }
        triangles += disks.triangles.size();
        most = std::max(most, disks.triangles.size());
    });
    CHECK(keys == 4961);
    CHECK(most == 24);
    CHECK(triangles == 70846);
}

}  // namespace

void test_cell_disks() { every_cell_is_sound(); }
