// Clusters of any triangles at all: as few as asked for, of vertices that are there, each in use.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "check.hpp"
#include "surface/clusters.hpp"

namespace {

using namespace isocore;

template <class Real>
void any_triangles_are_clustered(Real scale, std::size_t most) {
    std::mt19937 random(11);
    for (int trial = 0; trial < 40; ++trial) {
        const std::size_t count = 1 + random() % 200;
        std::vector<Real> vertices(3 * count);
        for (Real& coordinate : vertices) coordinate = scale * (static_cast<Real>(random() % 1000) / 500 - 1);
        std::vector<std::int32_t> triangles(3 * (random() % 400));
        for (std::int32_t& corner : triangles) corner = static_cast<std::int32_t>(random() % count);
        const MeshView<Real> mesh{vertices.data(), count, triangles.data(), triangles.size() / 3};
        const Clusters found = cluster(mesh, most);
        CHECK(found.triangles.size() <= 3 * most);
        std::vector<bool> is_used(found.kept.size());
        for (const std::int32_t corner : found.triangles) is_used.at(static_cast<std::size_t>(corner)) = true;
        CHECK(std::find(is_used.begin(), is_used.end(), false) == is_used.end());
        CHECK(std::is_sorted(found.kept.begin(), found.kept.end()));
        CHECK(found.kept.empty() || static_cast<std::size_t>(found.kept.back()) < count);
    }
}

}  // namespace

void test_clusters() {
    for (const std::size_t most : {0, 1, 30, 1000}) {
        any_triangles_are_clustered<float>(1, most);
        any_triangles_are_clustered<float>(0, most);
        any_triangles_are_clustered<double>(1e-310, most);
        any_triangles_are_clustered<double>(std::numeric_limits<double>::max(), most);
    }
}
