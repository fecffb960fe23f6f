// Propagation from the skeleton against a full scan, on small random meshes and volumes; and the parts it rests on.
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "check.hpp"
#include "marching_cells/marching_cells.hpp"
#include "marching_cubes/marching_cubes.hpp"
#include "tables/mesh_cases.hpp"
#include "thinning/grid/grid_thinning.hpp"
#include "thinning/mesh/edge_table.hpp"
#include "thinning/mesh/thinning.hpp"
#include "thinning/range_lookup.hpp"
#include "thinning/safe_rule.hpp"

namespace {

using namespace isocore;

struct Box {
    std::vector<double> points;
    std::vector<std::int32_t> tets, hexes;
    std::vector<double> values;
};

// Unit boxes along three axes, each as six tetrahedra around its diagonal and as one hexahedron in VTK's order.
Box make_box(int size, std::mt19937& random) {
    Box box;
    const int across = size + 1;
    const auto id = [&](int i, int j, int k) { return i + across * (j + across * k); };
    std::uniform_int_distribution<int> level(0, 4);
    for (int n = 0; n < across * across * across; ++n) {
        for (const int place : {n % across, n / across % across, n / across / across}) box.points.push_back(place);
        box.values.push_back(level(random));
    }
    for (int n = 0; n < size * size * size; ++n) {
        const int i = n % size, j = n / size % size, k = n / size / size;
        for (const auto& [a, b, c] :
             {std::array{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}) {
            box.hexes.push_back(id(i + a, j + b, k + c));
        }
        std::array<int, 3> order{0, 1, 2};
        do {
            std::array<int, 3> at{i, j, k};
            box.tets.push_back(id(at[0], at[1], at[2]));
            for (const int axis : order) {
                ++at[static_cast<std::size_t>(axis)];
                box.tets.push_back(id(at[0], at[1], at[2]));
            }
        } while (std::next_permutation(order.begin(), order.end()));
    }
    return box;
}

void walks_find_what_a_full_scan_finds() {
    std::mt19937 random(1);
    for (int trial = 0; trial < 20; ++trial) {
        Box box = make_box(trial < 18 ? 1 + trial % 4 : 14, random);  // the last two make several lots
        if (trial % 5 == 0) box.values[0] = std::numeric_limits<double>::quiet_NaN();
        if (trial % 2)
            box.tets.clear();
        else
            box.hexes.clear();
        const mesh::Field<double> field{box.points.data(), box.values.data(), box.values.size()};
        const std::size_t tets = box.tets.size() / 4, hexes = box.hexes.size() / 8;
        thinning::Index index = thinning::build(field, {box.tets.data(), box.hexes.data(), tets, hexes},
                                                {1 + trial % 2, trial % 3 == 0 ? 8u : 1u << 17});
        std::vector<double> points, values;
        for (const std::int32_t point : index.points) {
            points.insert(points.end(), field.point(point), field.point(point) + 3);
            values.push_back(field.value(point));
        }
        const auto view = [](const thinning::Part& part, std::size_t cells) {
            return thinning::PartView{
                part.records.data(), part.skeleton.data(), part.low.data(), part.high.data(), cells,
                part.skeleton.size()};
        };
        const thinning::IndexView at{view(index.tets, tets), view(index.hexes, hexes), index.points.data()};
        thinning::Scratch scratch;
        for (const double isovalue : {-1.0, 0.0, 0.5, 1.0, 2.0, 3.5, 4.0, 9.0}) {
            const mesh::Field<double> ordered{points.data(), values.data(), values.size()};
            const auto walked =
                thinning::propagate<double>(ordered, at, isovalue, 1 + trial % 3, trial % 2 == 0, scratch);
            const auto scanned =
                marching_cells::march<double>(field, {box.tets.data(), box.hexes.data(), tets, hexes}, isovalue, 1);
            CHECK(walked.visited == scanned.intersected);
            CHECK(walked.triangles.size() == scanned.triangles.size());
            CHECK(walked.vertices.size() == scanned.vertices.size());
        }
    }
}

void walks_through_volumes_find_what_marching_cubes_finds() {
    std::mt19937 random(2);
    std::uniform_int_distribution<int> level(0, 4);
    for (int trial = 0; trial < 20; ++trial) {
        const Dims dims{2u + static_cast<std::size_t>(trial) % 4, 3, 2u + static_cast<std::size_t>(trial) % 3};
        std::vector<std::uint8_t> samples(dims[0] * dims[1] * dims[2]);
        for (auto& sample : samples) sample = static_cast<std::uint8_t>(level(random));
        const GridView<std::uint8_t> grid{samples.data(), dims};
        const thinning::GridOptions options{trial % 2 == 1, trial % 3 == 1};
        const auto skeleton = thinning::thin_grid(grid, options);
        const std::size_t pad = options.capped ? 1 : 0;
        std::vector<std::int32_t> place((dims[0] + 2 * pad - 1) * (dims[1] + 2 * pad - 1) * (dims[2] + 2 * pad - 1));
        const thinning::GridSkeletonView view{skeleton.cells.data(), skeleton.low.data(), skeleton.high.data(),
                                              skeleton.cells.size(), place.data()};
        for (const double isovalue : {0.0, 1.0, 2.5, 4.0, 7.0}) {
            const auto walked = thinning::propagate_grid(grid, view, isovalue, options, 1 + trial % 3);
            marching_cubes::Options asked;
            asked.isovalue = isovalue;
            asked.below = options.below;
            asked.capped = options.capped;
            const auto marched = marching_cubes::march<std::uint8_t, double>(grid, asked);
            CHECK(walked.triangles.size() == marched.triangles.size());
            CHECK(walked.vertices.size() == marched.vertices.size());
        }
    }
}

void a_lookup_finds_every_interval_that_holds_a_value() {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> anywhere(0, 1);
    for (const std::size_t size : {0u, 1u, 15u, 16u, 17u, 256u, 257u, 5000u}) {
        std::vector<double> low(size), high(size);
        for (double& end : low) end = anywhere(random);
        std::sort(low.begin(), low.end());
        for (std::size_t n = 0; n < size; ++n) high[n] = low[n] + 0.1 * anywhere(random);
        const thinning::RangeLookup lookup(low.data(), high.data(), size);
        for (double value = -0.1; value < 1.2; value += 0.05) {
            std::vector<std::size_t> found, there;
            lookup.find(value, [&](std::size_t n) { found.push_back(n); });
            for (std::size_t n = 0; n < size; ++n) {
                if (low[n] < value && value <= high[n]) there.push_back(n);
            }
            CHECK(found == there);
        }
    }
}

// Every triangle has the inside corners of its cell behind it.
void a_table_numbers_edges_in_their_order_while_it_grows() {
    std::mt19937 random(4);
    std::uniform_int_distribution<std::int32_t> point(0, 40);
    thinning::EdgeTable table;
    thinning::EdgeList list;
    for (int run = 0; run < 3; ++run) {  // nothing is left of the run before
        table.start(1, list);
        std::vector<thinning::EdgeKey> seen;
        for (int batch = 0; batch < 100; ++batch) {
            std::vector<thinning::EdgeKey> edges(7);
            for (auto& edge : edges) edge = thinning::edge_key(point(random), 41 + point(random));
            std::vector<std::uint32_t> places(edges.size());
            table.place(edges.data(), edges.size(), places.data(), list);
            for (std::size_t n = 0; n < edges.size(); ++n) {
                const auto found = std::find(seen.begin(), seen.end(), edges[n]);
                CHECK(places[n] == static_cast<std::size_t>(found - seen.begin()));
                if (found == seen.end()) seen.push_back(edges[n]);
                CHECK(list[places[n]] == edges[n]);
            }
            CHECK(list.size() == seen.size());
        }
        CHECK(seen.size() > 300);
    }
}

void a_table_of_more_edges_than_16_bits_can_number() {
    constexpr std::int32_t kEdges = 70000;
    std::vector<thinning::EdgeKey> edges(kEdges);
    for (std::int32_t n = 0; n < kEdges; ++n) edges[static_cast<std::size_t>(n)] = thinning::edge_key(n, n + 1);
    thinning::EdgeTable table;
    thinning::EdgeList list;
    for (const std::size_t expected : {1, 4000, 70000}) {
        table.start(expected, list);
        for (int run = 0; run < 2; ++run) {
            std::vector<std::uint32_t> places(edges.size());
            table.place(edges.data(), edges.size(), places.data(), list);
            for (std::size_t n = 0; n < edges.size(); ++n) CHECK(places[n] == n && list[n] == edges[n]);
            CHECK(list.size() == edges.size());
        }
    }
}

void a_table_matches_the_edges_that_another_list_has_too() {
    std::mt19937 random(5);
    std::uniform_int_distribution<std::int32_t> point(0, 60);
    std::vector<thinning::EdgeKey> edges(900);
    for (auto& edge : edges) edge = thinning::edge_key(point(random), 61 + point(random));
    thinning::EdgeTable table;
    thinning::EdgeList list, others;
    table.start(edges.size(), list);
    std::vector<std::uint32_t> places(edges.size());
    table.place(edges.data(), edges.size(), places.data(), list);
    for (int n = 0; n < 700; ++n) others.push_back(thinning::edge_key(point(random), 61 + point(random)));
    std::size_t matched = 0, next = 0;
    table.match(others, list, [&](std::size_t other, std::size_t place) {
        for (; next < other; ++next) CHECK(std::find(edges.begin(), edges.end(), others[next]) == edges.end());
        CHECK(next++ == other && others[other] == list[place]);
        ++matched;
    });
    CHECK(matched > 50 && matched < others.size());
}

void triangles_of_a_tetrahedron_face_outside() {
    constexpr std::array<std::array<double, 3>, 4> kPlaces{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    for (unsigned signs = 1; signs < 15; ++signs) {
        const mesh::TetCase& drawn = mesh::kTetCases[signs];
        CHECK(drawn.triangles == (std::popcount(signs) == 2 ? 2 : 1));
        for (std::size_t t = 0; t < drawn.triangles; ++t) {
            std::array<std::array<double, 3>, 3> corner;
            for (std::size_t n = 0; n < 3; ++n) {
                const auto& ends = mesh::Tet::kShape.ends[drawn.edges[3 * t + n]];
                CHECK(((signs >> ends[0] ^ signs >> ends[1]) & 1) == 1);
                for (std::size_t axis = 0; axis < 3; ++axis)
                    corner[n][axis] = (kPlaces[ends[0]][axis] + kPlaces[ends[1]][axis]) / 2;
            }
            const auto side = [&](std::size_t n, std::size_t axis) { return corner[n][axis] - corner[0][axis]; };
            for (unsigned c = 0; c < 4; ++c) {
                double height = 0;
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
                    height +=
                        (kPlaces[c][axis] - corner[0][axis]) * (side(1, u) * side(2, v) - side(1, v) * side(2, u));
                }
                CHECK(signs >> c & 1 ? height < 0 : height > 0);
            }
        }
    }
}

// Two cells never draw a diagonal in the face they share, since none is drawn in any face.
void no_hexahedron_draws_a_diagonal_in_a_face() {
    for (const mesh::HexCase& drawn : mesh::kHexCases.cases) {
        CHECK(drawn.middles <= drawn.loops);
        for (std::size_t n = 0; n < 3u * drawn.triangles; ++n) {
            const int a = drawn.edges[n], b = drawn.edges[n % 3 == 2 ? n - 2 : n + 1];
            if (a >= 12 || b >= 12) continue;
            int uses = 0;
            for (std::size_t m = 0; m < 3u * drawn.triangles; ++m) {
                uses += drawn.edges[m] == b && drawn.edges[m % 3 == 2 ? m - 2 : m + 1] == a;
            }
            if (uses > 0) CHECK(cube::shared_face(a, b) < 0);
        }
    }
}

void connectedness_is_that_of_corners_and_edges() {
    CHECK(!thinning::connected<mesh::Tet>(0, 0));
    CHECK(thinning::connected<mesh::Tet>(1, 0));
    CHECK(!thinning::connected<mesh::Tet>(3, 0));
    CHECK(thinning::connected<mesh::Tet>(3, 1));
    CHECK(thinning::connected<mesh::Hex>(0xff, 0xfff));
    CHECK(!thinning::connected<mesh::Hex>(0xff, 0xf));
}

}  // namespace

void test_thinning() {
    a_table_numbers_edges_in_their_order_while_it_grows();
    a_table_of_more_edges_than_16_bits_can_number();
    a_table_matches_the_edges_that_another_list_has_too();
    triangles_of_a_tetrahedron_face_outside();
    no_hexahedron_draws_a_diagonal_in_a_face();
    connectedness_is_that_of_corners_and_edges();
    a_lookup_finds_every_interval_that_holds_a_value();
    walks_find_what_a_full_scan_finds();
    walks_through_volumes_find_what_marching_cubes_finds();
}
