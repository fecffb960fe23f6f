// Distances from points to triangles, several at once and in floats, against the plain definition in doubles.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include "check.hpp"
#include "common/facets.hpp"
#include "common/lanes.hpp"
#include "common/vectors.hpp"

namespace {

using namespace isocore;
using Exact = Vector<double>;
using Triangle = std::array<Spot, 3>;

Exact exact(const Spot& spot) {
    return {static_cast<double>(spot[0]), static_cast<double>(spot[1]), static_cast<double>(spot[2])};
}

double distance_to_side(const Exact& point, const Exact& from, const Exact& to) {
    const Exact along = minus(to, from), off = minus(point, from);
    const double squared = dot(along, along);
    const double t = squared > 0 ? std::clamp(dot(off, along) / squared, 0.0, 1.0) : 0.0;
    const Exact rest = minus(off, times(t, along));
    return std::sqrt(dot(rest, rest));
}

double distance(const Exact& point, const Triangle& triangle) {
    const std::array<Exact, 3> corners{exact(triangle[0]), exact(triangle[1]), exact(triangle[2])};
    const Exact normal = cross(minus(corners[1], corners[0]), minus(corners[2], corners[0]));
    double least = std::numeric_limits<double>::infinity();
    bool inside = dot(normal, normal) > 0;
    for (std::size_t side = 0; side < 3; ++side) {
        const Exact &from = corners[side], &to = corners[(side + 1) % 3];
        least = std::min(least, distance_to_side(point, from, to));
        inside = inside && dot(cross(normal, minus(to, from)), minus(point, from)) >= 0;
    }
    return inside ? std::abs(dot(normal, minus(point, corners[0]))) / std::sqrt(dot(normal, normal)) : least;
}

Spot random_spot(std::mt19937& random, float size) {
    std::uniform_real_distribution<float> place(0, size);
    return {place(random), place(random), place(random)};
}

// A triangle whose corners are apart by very different lengths.
Triangle random_triangle(std::mt19937& random, float size) {
    Triangle out;
    for (Spot& corner : out) corner = random_spot(random, size);
    for (std::size_t c = 1; c < 3; ++c) {
        if (random() % 3) continue;
        const Spot step = random_spot(random, size / 1000);
        for (std::size_t a = 0; a < 3; ++a) out[c][a] = out[0][a] + step[a];
    }
    std::shuffle(out.begin(), out.end(), random);
    return out;
}

void distances_are_those_of_the_definition() {
    std::mt19937 random(3);
    const auto facets = std::make_unique<Facets>();
    double furthest_off = 0;
    for (int trial = 0; trial < 3000; ++trial) {
        const float size = trial % 2 ? 16.0f : 2.0f;
        std::vector<Triangle> triangles(1 + random() % 40);
        for (Triangle& triangle : triangles) triangle = random_triangle(random, size);
        facets->clear();
        for (const Triangle& triangle : triangles) facets->add(triangle[0], triangle[1], triangle[2]);
        CHECK(facets->size() == triangles.size());
        facets->find_frames();

        const std::size_t first = random() % triangles.size(), count = 1 + random() % (triangles.size() - first);
        std::vector<Spot> points(1 + random() % 20);
        for (Spot& point : points) point = random_spot(random, size);
        Vector<std::vector<float>> rows;
        for (std::size_t a = 0; a < 3; ++a) {
            for (const Spot& point : points) rows[a].push_back(point[a]);
            rows[a].resize(points.size() + kLanes);
        }
        std::vector<float> found(points.size() + kLanes);
        facets->squared_distances(first, count, {rows[0].data(), rows[1].data(), rows[2].data()}, points.size(),
                                  found.data());
        for (std::size_t n = 0; n < points.size(); ++n) {
            double expected = std::numeric_limits<double>::infinity();
            for (std::size_t t = first; t < first + count; ++t)
                expected = std::min(expected, distance(exact(points[n]), triangles[t]));
            furthest_off = std::max(furthest_off, std::abs(std::sqrt(static_cast<double>(found[n])) - expected) /
                                                      static_cast<double>(size));
        }
    }
    CHECK(furthest_off < 1e-6);
}

}  // namespace

void test_facets() { distances_are_those_of_the_definition(); }
