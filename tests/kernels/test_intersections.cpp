// Sides of planes and lines against whole numbers that are reckoned exactly, and a surface against all its pairs.
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "check.hpp"
#include "surface/intersections/meeting.hpp"
#include "surface/intersections/orientation.hpp"
#include "surface/intersections/self_intersections.hpp"
#include "surface/nearness/distances.hpp"

namespace {

using namespace isocore;
using namespace isocore::intersections;
using Whole = std::array<std::int64_t, 3>;

Vec3 scaled(const Whole& point, double by) {
    return {static_cast<double>(point[0]) * by, static_cast<double>(point[1]) * by, static_cast<double>(point[2]) * by};
}

int sign(__int128 value) { return (value > 0) - (value < 0); }

int side_of(const Whole& a, const Whole& b, const Whole& c, const Whole& d) {
    std::array<std::array<__int128, 3>, 3> m;
    for (std::size_t n = 0; n < 3; ++n) {
        m[0][n] = a[n] - d[n];
        m[1][n] = b[n] - d[n];
        m[2][n] = c[n] - d[n];
    }
    return sign(m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) + m[1][0] * (m[2][1] * m[0][2] - m[2][2] * m[0][1]) +
                m[2][0] * (m[0][1] * m[1][2] - m[0][2] * m[1][1]));
}

// Points in one plane, or a unit off it: up to 2^38, where double precision cannot tell them apart.
void the_side_of_a_plane_is_exact() {
    std::mt19937_64 random(1);
    std::size_t exact = 0;
    for (int trial = 0; trial < 20000; ++trial) {
        const std::int64_t most = std::int64_t{1} << (3 + trial % 16);
        std::uniform_int_distribution<std::int64_t> any(-most, most);
        const auto point = [&] { return Whole{any(random), any(random), any(random)}; };
        const Whole a = point(), b = point(), c = point();
        Whole d;
        const std::int64_t s = any(random), t = any(random);
        for (std::size_t n = 0; n < 3; ++n) d[n] = a[n] + s * (b[n] - a[n]) + t * (c[n] - a[n]);
        d[static_cast<std::size_t>(trial) % 3] += trial / 3 % 3 - 1;
        const double by = std::ldexp(1.0, trial % 200 - 100);
        const Vec3 pa = scaled(a, by), pb = scaled(b, by), pc = scaled(c, by), pd = scaled(d, by);
        CHECK(plane_side(pa, pb, pc, pd) == side_of(a, b, c, d));
        CHECK(plane_side(pb, pa, pc, pd) == -side_of(a, b, c, d));
        exact += likely_plane_side(pa, pb, pc, pd) == 0;
    }
    CHECK(exact > 5000);
}

void the_side_of_a_line_is_exact() {
    std::mt19937_64 random(2);
    for (int trial = 0; trial < 20000; ++trial) {
        const std::int64_t most = std::int64_t{1} << (3 + trial % 22);
        std::uniform_int_distribution<std::int64_t> any(-most, most);
        const Whole a{any(random), any(random), 0}, b{any(random), any(random), 0};
        const std::int64_t t = any(random);
        const Whole c{a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]) + trial % 3 - 1, 0};
        const __int128 area =
            static_cast<__int128>(a[0] - c[0]) * (b[1] - c[1]) - static_cast<__int128>(a[1] - c[1]) * (b[0] - c[0]);
        CHECK(line_side(2, scaled(a, 1), scaled(b, 1), scaled(c, 1)) == sign(area));
    }
}

// The tree and the fans leave nothing out: against every pair of a crumpled sheet, whose corners all have numbers.
void a_sheet_is_counted_as_pair_by_pair() {
    std::mt19937 random(3);
    for (int trial = 0; trial < 40; ++trial) {
        const int size = 3 + trial % 8;
        std::normal_distribution<float> off(0.0F, 0.05F * static_cast<float>(trial % 12));
        std::vector<float> places;
        std::vector<std::int32_t> triangles;
        for (int y = 0; y <= size; ++y) {
            for (int x = 0; x <= size; ++x) {
                for (const int coordinate : {x, y, 0}) places.push_back(static_cast<float>(coordinate) + off(random));
                if (x == size || y == size) continue;
                const int a = y * (size + 1) + x, b = a + 1, c = a + size + 1, d = c + 1;
                for (const int corner : {a, b, d, a, d, c}) triangles.push_back(corner);
            }
        }
        const MeshView<float> sheet{places.data(), places.size() / 3, triangles.data(), triangles.size() / 3};
        std::size_t pairs = 0;
        for (std::size_t one = 0; one < sheet.triangle_count; ++one) {
            for (std::size_t other = 0; other < one; ++other) {
                const std::vector<std::int32_t> both{triangles[3 * one],       triangles[3 * one + 1],
                                                     triangles[3 * one + 2],   triangles[3 * other],
                                                     triangles[3 * other + 1], triangles[3 * other + 2]};
                pairs += self_intersections(MeshView<float>{places.data(), places.size() / 3, both.data(), 2}, 1);
            }
        }
        CHECK(self_intersections(sheet, 1 + trial % 3) == pairs);
    }
}

void distances_are_those_to_the_nearest_triangle() {
    const std::vector<double> corners{0, 0, 0, 4, 0, 0, 0, 4, 0, 0, 0, 9, 1, 0, 9, 0, 1, 9};
    const std::vector<std::int32_t> triangles{0, 1, 2, 3, 4, 5};
    const MeshView<double> mesh{corners.data(), 6, triangles.data(), 2};
    const std::vector<double> points{1, 1, 2, -3, 0, 4, 0, 0, 8, 5, 0, 0};
    const Distances found = distances_to(mesh, points.data(), 4, 2);
    CHECK(found.largest == 5);
    CHECK(std::abs(found.sum - (2 + 5 + 1 + 1)) < 1e-12);
    CHECK(std::abs(found.squares - (4 + 25 + 1 + 1)) < 1e-12);
}

// Points within a few last digits of the line through (12, 12) and (24, 24): doubles cannot tell, and the exact answer
// has the sign that doubles give further away.
void a_line_has_the_same_sides_near_and_far() {
    const double digit = 0x1p-53;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto placed = [&](double x, double y) {
            Vec3 point{};
            point[axis == 0 ? 1 : 0] = x;
            point[axis == 2 ? 1 : 2] = y;
            return point;
        };
        int undecided = 0;
        for (int x = 0; x < 16; ++x) {
            for (int y = 0; y < 16; ++y) {
                const Vec3 near = placed(0.5 + x * digit, 0.5 + y * digit), far = placed(0.5 + x, 0.5 + y);
                const Vec3 a = placed(12, 12), b = placed(24, 24);
                undecided += likely_line_side(axis, near, a, b) == 0;
                CHECK(line_side(axis, near, a, b) == line_side(axis, far, a, b));
                CHECK(line_side(axis, near, a, b) == (x < y) - (x > y));
            }
        }
        CHECK(undecided > 16);
    }
}

}  // namespace

void test_intersections() {
    the_side_of_a_plane_is_exact();
    the_side_of_a_line_is_exact();
    a_sheet_is_counted_as_pair_by_pair();
    distances_are_those_to_the_nearest_triangle();
    a_line_has_the_same_sides_near_and_far();
}
