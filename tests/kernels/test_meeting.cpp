// Signs of determinants against whole numbers, which do not round, and triangles that meet or only touch.
#include <array>
#include <cmath>
#include <cstdint>
#include <random>

#include "check.hpp"
#include "common/meeting.hpp"
#include "common/predicates.hpp"

namespace {

using namespace isocore;

int sign(std::int64_t n) { return n > 0 ? 1 : n < 0 ? -1 : 0; }

// Whole numbers far from 0, so that products of doubles round; their differences are small.
void signs_of_nearly_flat_corners_are_exact() {
    std::mt19937 random(1);
    std::uniform_int_distribution<std::int64_t> small(-3, 3);
    constexpr double kScale = 1.0 / 1048576, kManyBits = 536870909;  // the latter leaves no difference few bits
    for (int round = 0; round < 20000; ++round) {
        std::array<std::array<std::int64_t, 3>, 4> whole;
        std::array<Point, 4> points;
        for (std::size_t n = 0; n < 4; ++n) {
            for (std::size_t a = 0; a < 3; ++a) {
                whole[n][a] = small(random) + (n == 1 && a == 0 ? 100000 : n == 2 && a == 1 ? 100001 : 0);
                points[n][a] = static_cast<double>(whole[n][a] + 8388607) * kScale;
            }
        }
        const auto way = [&](std::size_t n, std::size_t a) { return whole[n][a] - whole[0][a]; };
        std::int64_t determinant = 0;
        for (std::size_t a = 0; a < 3; ++a) {
            const std::size_t b = (a + 1) % 3, c = (a + 2) % 3;
            determinant += way(3, a) * (way(1, b) * way(2, c) - way(1, c) * way(2, b));
        }
        CHECK(side_of_plane(points[0], points[1], points[2], points[3]) == sign(determinant));
        std::array<Point, 4> long_ones = points;
        for (Point& point : long_ones) {
            for (double& at : point) at *= kManyBits;
        }
        CHECK(side_of_plane(long_ones[0], long_ones[1], long_ones[2], long_ones[3]) == sign(determinant));
        for (std::size_t a = 0; a < 3; ++a) {
            const std::size_t b = (a + 1) % 3, c = (a + 2) % 3;
            const std::int64_t area = way(1, b) * way(2, c) - way(1, c) * way(2, b);
            CHECK(turn(points[0], points[1], points[2], a) == sign(area));
            CHECK(turn(long_ones[0], long_ones[1], long_ones[2], a) == sign(area));
        }
    }
}

// Differences that a double cannot hold.
void what_a_difference_loses_still_counts() {
    const Point a{0, 0, 0}, b{1, 0, 0}, c{0, 1, 0};
    CHECK(side_of_plane(a, b, c, {1e30, 1e30, 1e-30}) == 1);
    CHECK(side_of_plane({1e-30, 0, 0}, {1, 1, 1}, {1e-30, 1, 1}, {0, 0, 0}) == 0);
    CHECK(side_of_plane({1, 1, 1e-30}, {1e16, 1, 1e-30}, {1, 1e16, 1e-30}, {3, 5, 1e-30}) == 0);
    CHECK(side_of_plane({1, 1, 1e-30}, {1e16, 1, 1e-30}, {1, 1e16, 1e-30}, {3, 5, 2e-30}) == 1);
}

bool meets(const Corners3& one, const Corners3& other) {
    const bool found = meet(one, other);
    for (std::size_t n = 0; n < 3; ++n) {  // however the corners are turned, and whoever comes first
        for (std::size_t m = 0; m < 3; ++m) {
            const auto turned = [](const Corners3& t, std::size_t by) {
                Corners3 out = t;
                for (std::size_t k = 0; k < 3; ++k) {
                    out.numbers[k] = t.numbers[(k + by) % 3];
                    out.places[k] = t.places[(k + by) % 3];
                }
                return out;
            };
            CHECK(meet(turned(one, n), turned(other, m)) == found);
            CHECK(meet(turned(other, m), turned(one, n)) == found);
        }
    }
    return found;
}

void triangles_that_meet_are_found() {
    const Corners3 base{{0, 1, 2}, {Point{0, 0, 0}, Point{4, 0, 0}, Point{0, 4, 0}}};
    const auto stranger = [](const Point& a, const Point& b, const Point& c) { return Corners3{{3, 4, 5}, {a, b, c}}; };
    CHECK(meets(base, stranger({1, 1, -1}, {1, 1, 1}, {2, 1, 1})));
    CHECK(meets(base, stranger({1, 1, 0}, {1, 1, 1}, {2, 1, 1})));    // a corner in the plane
    CHECK(meets(base, stranger({4, 0, 0}, {5, 0, 1}, {5, 1, 1})));    // one place, two corners
    CHECK(meets(base, stranger({1, 1, 0}, {2, 1, 0}, {1, 2, 0})));    // one inside the other
    CHECK(meets(base, stranger({3, 3, 0}, {5, 3, 0}, {1, -1, 0})));   // in one plane, crossing
    CHECK(meets(base, stranger({2, -1, 0}, {3, -1, 0}, {2, 0, 0})));  // in one plane, touching
    CHECK(!meets(base, stranger({3, 3, 0}, {5, 3, 0}, {3, 5, 0})));
    CHECK(!meets(base, stranger({1, 1, 1e-30}, {2, 1, 1}, {1, 2, 1})));
    CHECK(!meets(base, stranger({3, 3, -1}, {3, 3, 1}, {5, 5, 0})));
    const auto at_corner = [](const Point& b, const Point& c) { return Corners3{{0, 4, 5}, {Point{0, 0, 0}, b, c}}; };
    CHECK(meets(base, at_corner({1, 1, 1}, {1, 1, -1})));
    CHECK(meets(base, at_corner({1, 1, 0}, {1, 1, 1})));
    CHECK(meets(base, at_corner({1, 2, 0}, {2, 1, 0})));
    CHECK(!meets(base, at_corner({-1, -1, 1}, {-1, -1, -1})));
    CHECK(!meets(base, at_corner({-1, 0, 0}, {0, -1, 0})));
    CHECK(!meets(base, at_corner({1, 1, 1}, {1, 2, 1})));
    const auto at_side = [](const Point& c) { return Corners3{{0, 1, 5}, {Point{0, 0, 0}, Point{4, 0, 0}, c}}; };
    CHECK(meets(base, at_side({1, 1, 0})));
    CHECK(!meets(base, at_side({1, -1, 0})));
    CHECK(!meets(base, at_side({1, 1, 1e-30})));
    CHECK(meets(base, base));
}

}  // namespace

void test_meeting() {
    signs_of_nearly_flat_corners_are_exact();
    what_a_difference_loses_still_counts();
    triangles_that_meet_are_found();
}
