// Loops triangulated one at a time and several at once, against all triangulations there are.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <random>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "check.hpp"
#include "climbing/triangles/polygon.hpp"
#include "climbing/triangles/polygons.hpp"
#include "common/vectors.hpp"

namespace {

using namespace isocore;
using namespace isocore::climbing;
using Triangles = std::vector<std::array<std::size_t, 3>>;

struct Loop {
    std::vector<Spot> places;
    std::vector<unsigned> faces;  // of each corner, a bit each

    bool may_join(std::size_t i, std::size_t j) const {
        return j == i + 1 || (i == 0 && j + 1 == places.size()) || !(faces[i] & faces[j]);
    }
    double area(std::size_t i, std::size_t j, std::size_t k) const {
        const auto exact = [&](std::size_t n) -> Vector<double> {
            return {static_cast<double>(places[n][0]), static_cast<double>(places[n][1]),
                    static_cast<double>(places[n][2])};
        };
        const auto normal = cross(minus(exact(j), exact(i)), minus(exact(k), exact(i)));
        return std::sqrt(dot(normal, normal));
    }
    // Of the best triangles between corners i ... j; infinite if there are none.
    double least_area(std::size_t i, std::size_t j) const {
        if (!may_join(i, j)) return std::numeric_limits<double>::infinity();
        if (j == i + 1) return 0;
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t k = i + 1; k < j; ++k)
            least = std::min(least, least_area(i, k) + least_area(k, j) + area(i, k, j));
        return least;
    }
    double least_area() const { return least_area(0, places.size() - 1); }
};

Loop random_loop(std::mt19937& random, std::size_t length) {
    std::uniform_real_distribution<float> place(0, 8);
    Loop loop;
    for (std::size_t n = 0; n < length; ++n) {
        loop.places.push_back({place(random), place(random), place(random)});
        loop.faces.push_back(1u << random() % 6 | (random() % 2 ? 1u << random() % 6 : 0u));
    }
    return loop;
}

// Do the triangles cover the loop once, without a diagonal that may not be, and as cheaply as can be?
void check(const Loop& loop, const Triangles& triangles) {
    const std::size_t length = loop.places.size();
    CHECK(triangles.size() == length - 2);
    std::map<std::pair<std::size_t, std::size_t>, int> sides;  // each one way
    double area = 0;
    for (const auto& triangle : triangles) {
        for (std::size_t n = 0; n < 3; ++n) ++sides[{triangle[n], triangle[(n + 1) % 3]}];
        area += loop.area(triangle[0], triangle[1], triangle[2]);
    }
    for (const auto& [side, count] : sides) {
        const auto [from, to] = side;
        const bool is_of_loop = to == (from + 1) % length;
        CHECK(count == 1);
        CHECK(is_of_loop || (loop.may_join(std::min(from, to), std::max(from, to)) && sides.count({to, from}) == 1));
    }
    CHECK(sides.size() == length + 2 * (length - 3));
    const double least = loop.least_area();
    CHECK(area <= least * (1 + 1e-5));  // floats, in which nearly equal areas are as good
}

void one_loop_is_triangulated_with_the_least_area() {
    std::mt19937 random(21);
    Polygon polygon;
    for (int trial = 0; trial < 4000; ++trial) {
        const Loop loop = random_loop(random, 3 + random() % 8);
        polygon.resize(loop.places.size());
        for (std::size_t n = 0; n < loop.places.size(); ++n)
            polygon.set(n, loop.places[n], loop.faces[n], static_cast<std::int32_t>(n));
        bool is_done = true;
        Triangles triangles;
        try {
            for (const auto& triangle : polygon.triangulate())
                triangles.push_back({triangle[0], triangle[1], triangle[2]});
        } catch (const std::logic_error&) {
            is_done = false;
        }
        CHECK(is_done == std::isfinite(loop.least_area()));
        if (is_done) check(loop, triangles);
    }
}

template <std::size_t length>
void several_loops_are_triangulated_with_the_least_area() {
    std::mt19937 random(22);
    Polygons<length> polygons;
    for (int trial = 0; trial < 400; ++trial) {
        std::vector<Loop> loops;
        for (std::size_t n = 1 + random() % polygons.kCount; n > 0; --n) loops.push_back(random_loop(random, length));
        bool all_can_be = true;
        for (std::size_t n = 0; n < loops.size(); ++n) {
            for (std::size_t c = 0; c < length; ++c)
                polygons.set(n, c, loops[n].places[c], loops[n].faces[c], static_cast<std::int32_t>(100 * n + c));
            all_can_be = all_can_be && std::isfinite(loops[n].least_area());
        }
        bool is_done = true;
        try {
            polygons.triangulate(loops.size());
        } catch (const std::logic_error&) {
            is_done = false;
        }
        CHECK(is_done == all_can_be);
        for (std::size_t n = 0; n < loops.size(); ++n) {
            if (!std::isfinite(loops[n].least_area())) continue;
            const auto triangles = polygons.triangles(n);
            check(loops[n], Triangles(triangles.begin(), triangles.end()));
            CHECK(polygons.vertex(n, length - 1) == static_cast<std::int32_t>(100 * n + length - 1));
            CHECK(polygons.place(n, 0) == loops[n].places[0]);
        }
    }
}

}  // namespace

void test_polygons() {
    one_loop_is_triangulated_with_the_least_area();
    several_loops_are_triangulated_with_the_least_area<3>();
    several_loops_are_triangulated_with_the_least_area<4>();
    several_loops_are_triangulated_with_the_least_area<5>();
    several_loops_are_triangulated_with_the_least_area<6>();
    several_loops_are_triangulated_with_the_least_area<7>();
    several_loops_are_triangulated_with_the_least_area<8>();
}
