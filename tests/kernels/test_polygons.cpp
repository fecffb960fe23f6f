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
    std::vector<unsigned> faces;   // of each corner, a bit each
    std::vector<Spot> directions;  // where the samples fall at each corner; none where area alone is asked for

    bool may_join(std::size_t i, std::size_t j) const {
        return j == i + 1 || (i == 0 && j + 1 == places.size()) || !(faces[i] & faces[j]);
    }
    // Twice the area, and as much again as each corner's direction is tilted: 1 less the cosine.
    double cost(std::size_t i, std::size_t j, std::size_t k) const {
        const auto exact = [](const Spot& at) -> Vector<double> {
            return {static_cast<double>(at[0]), static_cast<double>(at[1]), static_cast<double>(at[2])};
        };
        const auto normal = cross(minus(exact(places[j]), exact(places[i])), minus(exact(places[k]), exact(places[i])));
        const double area = std::sqrt(dot(normal, normal));
        if (directions.empty()) return area;
        double sum = area;
        for (const std::size_t n : {i, j, k}) sum += area * (1 - dot(normal, exact(directions[n])) / area);
        return sum;
    }
    // Of the best triangles between corners i ... j; infinite if there are none.
    double least_cost(std::size_t i, std::size_t j) const {
        if (!may_join(i, j)) return std::numeric_limits<double>::infinity();
        if (j == i + 1) return 0;
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t k = i + 1; k < j; ++k)
            least = std::min(least, least_cost(i, k) + least_cost(k, j) + cost(i, k, j));
        return least;
    }
    double least_cost() const { return least_cost(0, places.size() - 1); }
};

Spot random_direction(std::mt19937& random) {
    std::normal_distribution<float> component;
    const Spot way{component(random), component(random), component(random)};
    return times(1 / std::sqrt(dot(way, way)), way);
}

Loop random_loop(std::mt19937& random, std::size_t length, bool tilted) {
    std::uniform_real_distribution<float> place(0, 8);
    Loop loop;
    for (std::size_t n = 0; n < length; ++n) {
        loop.places.push_back({place(random), place(random), place(random)});
        loop.faces.push_back(1u << random() % 6 | (random() % 2 ? 1u << random() % 6 : 0u));
        if (tilted) loop.directions.push_back(random_direction(random));
    }
    return loop;
}

// Do the triangles cover the loop once, without a diagonal that may not be, and as cheaply as can be?
void check(const Loop& loop, const Triangles& triangles) {
    const std::size_t length = loop.places.size();
    CHECK(triangles.size() == length - 2);
    std::map<std::pair<std::size_t, std::size_t>, int> sides;  // each one way
    double cost = 0;
    for (const auto& triangle : triangles) {
        for (std::size_t n = 0; n < 3; ++n) ++sides[{triangle[n], triangle[(n + 1) % 3]}];
        cost += loop.cost(triangle[0], triangle[1], triangle[2]);
    }
    for (const auto& [side, count] : sides) {
        const auto [from, to] = side;
        const bool is_of_loop = to == (from + 1) % length;
        CHECK(count == 1);
        CHECK(is_of_loop || (loop.may_join(std::min(from, to), std::max(from, to)) && sides.count({to, from}) == 1));
    }
    CHECK(sides.size() == length + 2 * (length - 3));
    const double least = loop.least_cost();
    CHECK(cost <= least * (1 + 1e-5));  // floats, in which nearly equal costs are as good
}

void one_loop_is_triangulated_with_the_least_cost(bool tilted) {
    std::mt19937 random(21);
    Polygon polygon;
    for (int trial = 0; trial < 4000; ++trial) {
        const Loop loop = random_loop(random, 3 + random() % 8, tilted);
        polygon.resize(loop.places.size());
        for (std::size_t n = 0; n < loop.places.size(); ++n)
            polygon.set(n, loop.places[n], loop.faces[n], static_cast<std::int32_t>(n));
        for (std::size_t n = 0; n < loop.directions.size(); ++n) polygon.set_direction(n, loop.directions[n]);
        bool is_done = true;
        Triangles triangles;
        try {
            for (const auto& triangle : polygon.triangulate(tilted))
                triangles.push_back({triangle[0], triangle[1], triangle[2]});
        } catch (const std::logic_error&) {
            is_done = false;
        }
        CHECK(is_done == std::isfinite(loop.least_cost()));
        if (is_done) check(loop, triangles);
    }
}

template <std::size_t length>
void several_loops_are_triangulated_with_the_least_cost(bool tilted) {
    std::mt19937 random(22);
    Polygons<length> polygons;
    for (int trial = 0; trial < 400; ++trial) {
        std::vector<Loop> loops;
        for (std::size_t n = 1 + random() % polygons.kCount; n > 0; --n)
            loops.push_back(random_loop(random, length, tilted));
        bool all_can_be = true;
        for (std::size_t n = 0; n < loops.size(); ++n) {
            for (std::size_t c = 0; c < length; ++c)
                polygons.set(n, c, loops[n].places[c], loops[n].faces[c], static_cast<std::int32_t>(100 * n + c));
            for (std::size_t c = 0; c < loops[n].directions.size(); ++c)
                polygons.set_direction(n, c, loops[n].directions[c]);
            all_can_be = all_can_be && std::isfinite(loops[n].least_cost());
        }
        bool is_done = true;
        try {
            polygons.triangulate(loops.size(), tilted);
        } catch (const std::logic_error&) {
            is_done = false;
        }
        CHECK(is_done == all_can_be);
        for (std::size_t n = 0; n < loops.size(); ++n) {
            if (!std::isfinite(loops[n].least_cost())) continue;
            const auto triangles = polygons.triangles(n);
            check(loops[n], Triangles(triangles.begin(), triangles.end()));
            CHECK(polygons.vertex(n, length - 1) == static_cast<std::int32_t>(100 * n + length - 1));
            CHECK(polygons.place(n, 0) == loops[n].places[0]);
        }
    }
}

}  // namespace

void test_polygons() {
    for (const bool tilted : {false, true}) {
        one_loop_is_triangulated_with_the_least_cost(tilted);
        several_loops_are_triangulated_with_the_least_cost<3>(tilted);
        several_loops_are_triangulated_with_the_least_cost<4>(tilted);
        several_loops_are_triangulated_with_the_least_cost<5>(tilted);
        several_loops_are_triangulated_with_the_least_cost<6>(tilted);
        several_loops_are_triangulated_with_the_least_cost<7>(tilted);
        several_loops_are_triangulated_with_the_least_cost<8>(tilted);
    }
}
