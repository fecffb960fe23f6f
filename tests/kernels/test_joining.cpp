// Each point is joined with the first at its place, or within the distance, as a search among all earlier ones finds
// it.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "check.hpp"
#include "joining/join_points.hpp"

namespace {

using namespace isocore;

double distance_of(const std::vector<double>& points, std::size_t a, std::size_t b) {
    double sum = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double step = points[3 * a + axis] - points[3 * b + axis];
        sum += step * step;
    }
    return std::sqrt(sum);
}

std::vector<std::int32_t> searched(const std::vector<double>& points, double distance) {
    std::vector<std::int32_t> with(points.size() / 3);
    for (std::size_t n = 0; n < with.size(); ++n) {
        with[n] = static_cast<std::int32_t>(n);
        for (std::size_t earlier = 0; earlier < n; ++earlier) {
            const bool stands_for_itself = with[earlier] == static_cast<std::int32_t>(earlier);
            if (stands_for_itself && distance_of(points, earlier, n) <= distance) {
                with[n] = static_cast<std::int32_t>(earlier);
                break;
            }
        }
    }
    return with;
}

// Which point each is joined with.
std::vector<std::int32_t> with(const JoinedPoints& found) {
    std::vector<std::int32_t> with;
    for (const std::int32_t number : found.number) with.push_back(found.first[static_cast<std::size_t>(number)]);
    return with;
}

void points_go_where_a_search_finds(double step, double distance) {
    std::mt19937 random(7);
    for (int trial = 0; trial < 30; ++trial) {
        std::vector<double> points(3 * (random() % 400));
        const auto steps = static_cast<unsigned>(1 + random() % 9);
        for (double& coordinate : points) coordinate = step * static_cast<double>(random() % steps) - step;
        const JoinedPoints found = join_points(points.data(), points.size() / 3, distance);
        const std::vector<std::int32_t> expected = searched(points, distance);
        CHECK(with(found) == expected);
        CHECK(std::is_sorted(found.first.begin(), found.first.end()));
        std::size_t joined = 0;
        for (std::size_t n = 0; n < expected.size(); ++n) joined += expected[n] != static_cast<std::int32_t>(n);
        CHECK(expected.size() - found.first.size() == joined);
    }
}

// The table grows beyond what its first points made one expect: places are named anew only after many that are not.
void the_points_of_a_large_mesh_are_joined() {
    constexpr std::size_t kPoints = 400000;
    std::vector<double> points(3 * kPoints);
    for (std::size_t n = 0; n < kPoints; ++n) {
        const std::size_t place = n % (kPoints / 2);
        points[3 * n] = static_cast<double>(place % 100);
        points[3 * n + 1] = static_cast<double>(place / 100 % 100) / 3;
        points[3 * n + 2] = n % 7 == 0 && place < 10000 ? -0.0 : static_cast<double>(place / 10000);
    }
    for (std::size_t n = 3 * 1000; n < 3 * 100000; ++n) points[n] = points[n % 3000];
    const std::vector<std::int32_t> found = with(join_points(points.data(), kPoints, 0));
    for (std::size_t n = 0; n < kPoints; ++n) {
        const std::size_t place = n % (kPoints / 2);
        const std::size_t expected = n < 100000                                            ? n % 1000
                                     : n >= kPoints / 2 && place >= 1000 && place < 100000 ? n
                                                                                           : place;
        CHECK(found[n] == static_cast<std::int32_t>(expected));
    }
}

}  // namespace

void test_joining() {
    points_go_where_a_search_finds(0.25, 0);
    points_go_where_a_search_finds(0.25, 0.3);
    points_go_where_a_search_finds(0.1, 1.5);
    the_points_of_a_large_mesh_are_joined();
}
