// Simplification of small random volumes under sanitizers: the counts fit, and threads change nothing. What it promises
// is told by brute force in tests/algorithms/test_simplification.py.
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "check.hpp"
#include "labels/label_mesh.hpp"
#include "labels/sheets.hpp"
#include "marching_cubes/marching_cubes.hpp"
#include "simplification/patch.hpp"
#include "simplification/simplify.hpp"

namespace {

using namespace isocore;
using simplification::MeshArrays;
using simplification::Simplified;

struct Volume {
    Dims dims;
    std::vector<float> samples;
};

// Waves with noise; every third is noise alone.
Volume volume_of(int seed, const Dims& most) {
    std::mt19937 random(static_cast<unsigned>(seed));
    std::uniform_real_distribution<float> noise(-1, 1);
    Volume out{most, {}};
    for (std::size_t& length : out.dims) length -= random() % 3;
    for (std::size_t k = 0; k < out.dims[2]; ++k) {
        for (std::size_t j = 0; j < out.dims[1]; ++j) {
            for (std::size_t i = 0; i < out.dims[0]; ++i) {
                const float wave = std::sin(0.6f * static_cast<float>(i)) + std::cos(0.5f * static_cast<float>(j)) +
                                   std::sin(0.4f * static_cast<float>(k));
                out.samples.push_back(seed % 3 == 0 ? noise(random) : wave + 0.2f * noise(random));
            }
        }
    }
    return out;
}

template <class Real>
void simplify(int seed, const Dims& most, double bound, std::size_t most_triangles) {
    const Volume volume = volume_of(seed, most);
    marching_cubes::Options asked;
    asked.capped = seed % 2 == 0;
    const auto marched = marching_cubes::march<float, Real>({volume.samples.data(), volume.dims}, asked);
    const MeshArrays<Real> mesh{marched.vertices.data(), marched.vertices.size() / 3, marched.triangles.data(),
                                marched.triangles.size() / 3};
    simplification::Options options;
    options.max_error = bound;
    options.stretch = {1, 0.7, 0.4};
    options.most_triangles = most_triangles;
    const Simplified<Real> found = simplification::simplify(mesh, mesh, options);
    CHECK(found.triangles.size() / 3 + 2 * found.facts.collapses == mesh.triangle_count);
    CHECK(found.vertices.size() / 3 + found.facts.collapses == mesh.vertex_count);
    CHECK(found.facts.error.max <= bound);
    CHECK(found.facts.unproved == 0 || !std::isfinite(bound));
    options.threads = 3;
    const Simplified<Real> again = simplification::simplify(mesh, mesh, options);
    CHECK(found.vertices == again.vertices && found.triangles == again.triangles);
}

// The first phase makes a mesh for each box, or one mesh of all.
void apart_as_together(const MeshArrays<float>& mesh, const MeshArrays<float>& reference, const Writing& writing) {
    simplification::Options options;
    options.max_error = 0.5;
    options.writing = writing;
    options.other = {1, 2, 3};
    options.together = true;
    const Simplified<float> together = simplification::simplify(mesh, reference, options);
    options.together = false;
    for (const int threads : {1, 3}) {
        options.threads = threads;
        const Simplified<float> apart = simplification::simplify(mesh, reference, options);
        CHECK(apart.vertices == together.vertices && apart.triangles == together.triangles);
        CHECK(apart.kept == together.kept && apart.left == together.left);
        CHECK(apart.facts.collapses == together.facts.collapses && apart.facts.collapses > 0);
        CHECK(apart.facts.refused == together.facts.refused);
        CHECK(apart.facts.back_max == together.facts.back_max);
        CHECK(apart.facts.error.sum == together.facts.error.sum);
        CHECK(apart.facts.other.squares == together.facts.other.squares);
        CHECK(apart.facts.sheets.size() == together.facts.sheets.size());
        for (std::size_t n = 0; n < apart.facts.sheets.size(); ++n) {
            CHECK(apart.facts.sheets[n].refused == together.facts.sheets[n].refused);
            CHECK(apart.facts.sheets[n].error.sum == together.facts.sheets[n].error.sum);
        }
    }
}

void apart_as_together(const MeshArrays<float>& mesh, const MeshArrays<float>& reference) {
    apart_as_together(mesh, reference, {});
    apart_as_together(mesh, reference, {{0.96, 0.28, 0, 3000, -0.28, 0.96, 0, 3000, 0, 0, 1, 3000}, true, 4e-4});
}

void apart_as_together() {
    const Volume volume = volume_of(1, {75, 70, 9});
    const auto marched = marching_cubes::march<float, float>({volume.samples.data(), volume.dims}, {});
    const MeshArrays<float> fine{marched.vertices.data(), marched.vertices.size() / 3, marched.triangles.data(),
                                 marched.triangles.size() / 3};
    apart_as_together(fine, fine);
    // A coarser mesh: the reference's other vertices are witnesses of its triangles.
    simplification::Options close;
    close.max_error = 0.1;
    const Simplified<float> fewer = simplification::simplify(fine, fine, close);
    apart_as_together(
        {fewer.vertices.data(), fewer.vertices.size() / 3, fewer.triangles.data(), fewer.triangles.size() / 3}, fine);
    std::vector<std::uint8_t> labels;
    for (const float sample : volume.samples)
        labels.push_back(sample < -0.5f ? 0 : sample < 0.3f ? 1 : sample < 1 ? 2 : 3);
    const std::vector<double> values{0, 1, 2, 3};
    const std::vector<std::uint32_t> ranks{0, 1, 2, 3};
    auto mesh = labels::extract<std::uint8_t>({labels.data(), volume.dims}, {values, ranks}, 1);
    const auto sheets = labels::take_sheets(mesh);
    const MeshArrays<float> shared{mesh.vertices.data(),      mesh.vertices.size() / 3, mesh.triangles.data(),
                                   mesh.triangles.size() / 3, &sheets.of_triangles,     sheets.pairs.size() / 2};
    apart_as_together(shared, shared);
}

// A patch is counted in: each triangle of the reference is there once, in however many cells it lies.
void gather_large_triangles() {
    const std::vector<float> vertices{0, 0, 0, 4.5f, 0.2f, 0.1f, 0.3f, 5.5f, 0.4f, 5.1f, 4.9f, 3.2f};
    const std::vector<std::int32_t> triangles{0, 1, 2, 2, 1, 3};
    const MeshArrays<float> arrays{vertices.data(), 4, triangles.data(), 2};
    const auto cells = simplification::Cells::around(arrays, 1.0);
    const simplification::Reference<float> reference(arrays, cells);
    simplification::Mesh<float> mesh({1, 1, 1}, {});
    mesh.take_all(arrays, cells, 1);
    CHECK(reference.index().repeats());
    simplification::Rows rows;
    simplification::Patch patch;
    patch.gather(reference, rows, mesh, {0, 0, 0}, {{-1, -1, -1}, {6, 6, 6}}, 0);
    CHECK(patch.size() == 2);
    patch.gather(reference, rows, mesh, {0, 0, 0}, {{0.1f, 0.1f, 0}, {1.5f, 0.9f, 0.2f}}, 0);
    CHECK(patch.size() == 2);
}

// Copies are what the reference has, in its order.
void gather_from_rows() {
    const Volume volume = volume_of(1, {70, 9, 8});
    const auto marched = marching_cubes::march<float, float>({volume.samples.data(), volume.dims}, {});
    const MeshArrays<float> arrays{marched.vertices.data(), marched.vertices.size() / 3, marched.triangles.data(),
                                   marched.triangles.size() / 3};
    const auto cells = simplification::Cells::around(arrays, 1.0);
    const simplification::Reference<float> reference(arrays, cells);
    simplification::Mesh<float> mesh({1, 0.7, 0.4}, {});
    mesh.take_all(arrays, cells, 1);
    simplification::Rows none, rows;
    rows.cover({3, 0, 1}, {60, 6, 5});
    simplification::Patch read, copied;
    for (std::int32_t i = 4; i < 50; i += 3) {
        const std::array<float, 3> origin{static_cast<float>(i), 3, 3};
        const simplification::Box box{{-0.9f, -1.3f, -0.7f}, {static_cast<float>(i % 9), 2, 0.6f}};
        read.gather(reference, none, mesh, origin, box, 0);
        copied.gather(reference, rows, mesh, origin, box, 0);
        CHECK(read.size() > 0 && read.size() == copied.size());
        for (std::size_t n = 0; n < 3 * read.size(); ++n)
            CHECK(read.corner(n / 3, n % 3) == copied.corner(n / 3, n % 3));
        for (std::size_t n = 0; n < read.size(); n += kLanes) {
            const unsigned there = read.size() - n < kLanes ? (1u << (read.size() - n)) - 1 : 255u;
            CHECK((read.at_border(n) & there) == (copied.at_border(n) & there));
        }
    }
}

}  // namespace

void test_simplification() {
    gather_large_triangles();
    gather_from_rows();
    for (int seed = 0; seed < 30; ++seed) simplify<float>(seed, {9, 8, 7}, 0.2 + 0.2 * (seed % 4), 0);
    for (int seed = 0; seed < 3; ++seed) simplify<double>(seed, {12, 13, 12}, 0.5, 0);
    for (int seed = 0; seed < 3; ++seed) simplify<float>(seed, {9, 9, 9}, std::numeric_limits<double>::infinity(), 20);
    simplify<float>(1, {150, 8, 7}, 0.5, 0);  // several boxes
    apart_as_together();
}
