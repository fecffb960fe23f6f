// smooth.cpp - G. Taubin, "A signal processing approach to fair surface design", SIGGRAPH 1995: a step towards the mean
// of the neighbours and a larger one back. A step does not take the mean's direction, in which a vertex of a grid edge
// can hardly move, but goes to where the smoothed surface meets the edge: README.md.
#include "labels/smooth.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "common/large_pages.hpp"
#include "common/parallel.hpp"
#include "common/waves.hpp"
#include "labels/curve_vertices.hpp"
#include "labels/edge_vertices.hpp"
#include "labels/shape.hpp"
#include "labels/sliding.hpp"

namespace isocore::labels {
namespace {

constexpr float kSmoothing = 0.5f, kUndoing = -0.53f;
constexpr int kSamePace = 8;  // steps for which normals are good enough, once the first have smoothed them

// task(begin, end) for a share of all vertices on each thread.
template <class Task>
void share_vertices(int threads, std::size_t vertices, const Task& task) {
    const auto shares = static_cast<std::size_t>(std::max(threads, 1));
    const auto start = [&](std::size_t share) { return vertices * share / shares; };
    parallel_for(threads, shares, [&](std::size_t n) { task(start(n), start(n + 1)); });
}

template <class Coordinate>
Places places_of(const Coordinate* vertices, std::size_t count, int threads) {
    Places places = large_array<Lanes>(count);
    share_vertices(threads, count, [&](std::size_t begin, std::size_t end) {
        for (std::size_t n = begin; n < end; ++n) {
            const auto at = [&](std::size_t axis) { return static_cast<float>(vertices[3 * n + axis]); };
            places[n] = Lanes{at(0), at(1), at(2), 0};
        }
    });
    return places;
}

// Only what has moved is written back: other coordinates keep all their digits.
template <class Coordinate>
void write_back(const Places& places, std::span<const Element> elements, Coordinate* vertices, int threads) {
    share_vertices(threads, places.size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t n = begin; n < end; ++n) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                if (elements[n] >> axis & 1) vertices[3 * n + axis] = static_cast<Coordinate>(places[n][axis]);
            }
        }
    });
}

// Moves `from` by so many rounds. curves_of: the mesh, if any vertices lie on curves. far: how far apart the numbers of
// neighbours are at most, which a Way holds.
template <class Way>
void run_with(const Shape& shape, const LabelMesh& curves_of, std::size_t far, int rounds, int threads, Places& from) {
    Places to = large_array<Lanes>(from.size());
    share_vertices(threads, from.size(), [&](std::size_t begin, std::size_t end) {
        std::copy_n(from.data() + begin, end - begin, to.data() + begin);
    });
    std::optional<EdgeVertices<Way>> edges;
    std::optional<CurveVertices> curves;
    // What other threads free stays with them: so the longest lists are made here.
    auto of_edges = large_array<std::uint32_t>(shape.elements.size());
    auto of_curves = large_array<std::uint32_t>(curves_of.curves.empty() ? 0 : shape.elements.size() + 1);
    parallel_for(threads, 2, [&](std::size_t n) {
        if (n == 0)
            edges.emplace(shape, std::move(of_edges));
        else
            curves.emplace(curves_of, std::move(of_curves));
    });
    edges->find_neighbours(shape, threads);
    const std::size_t reach = far / kBlock + 1;
    for (int first = 0; first < rounds;) {
        const int steps = std::min(rounds - first, first == 0 ? kSamePace / 2 : kSamePace);
        edges->renew_normals(from, threads);
        in_waves(threads, static_cast<std::size_t>(steps), edges->blocks(), reach,
                 [&](std::size_t step, std::size_t block) {
                     const float factor = step % 2 == 0 ? kSmoothing : kUndoing;
                     const Places& before = step % 2 == 0 ? from : to;
                     Places& after = step % 2 == 0 ? to : from;
                     edges->step(block, before, after, factor, step == 0);
                     curves->step(block, before, after, factor, step == 0);
                 });
        if (steps % 2 != 0) std::swap(from, to);
        first += steps;
    }
}

void run(const Shape& shape, const LabelMesh& curves_of, int rounds, int threads, Places& from) {
    const std::size_t far = farthest_corners(shape.triangles, threads);
    if (far <= std::numeric_limits<std::int16_t>::max())
        run_with<std::int16_t>(shape, curves_of, far, rounds, threads, from);
    else
        run_with<std::int32_t>(shape, curves_of, far, rounds, threads, from);
}

}  // namespace

namespace {

// Moves the vertices while nothing else is there of the mesh but what that takes: their places say as much as they do,
// and most ranks fit into a byte.
template <class Rank>
void smooth_with(LabelMesh& mesh, int rounds, int threads) {
    const std::size_t count = mesh.elements.size();
    Array<Rank> sides(mesh.sides.size());
    std::transform(mesh.sides.begin(), mesh.sides.end(), sides.begin(),
                   [](std::uint32_t rank) { return static_cast<Rank>(rank); });
    Array<std::uint32_t>().swap(mesh.sides);
    Places places = places_of(mesh.vertices.data(), count, threads);
    Array<float>().swap(mesh.vertices);
    run({mesh.elements, mesh.triangles, false}, mesh, rounds, threads, places);
    mesh.vertices = large_array<float>(3 * count);
    share_vertices(threads, count, [&](std::size_t begin, std::size_t end) {
        for (std::size_t n = begin; n < end; ++n) {
            for (std::size_t axis = 0; axis < 3; ++axis) mesh.vertices[3 * n + axis] = places[n][axis];
        }
    });
    Places().swap(places);
    mesh.sides.assign(sides.begin(), sides.end());
}

}  // namespace

void smooth(LabelMesh& mesh, int rounds, int threads) {
    if (rounds <= 0) return;
    const auto highest = std::max_element(mesh.sides.begin(), mesh.sides.end());
    if (highest == mesh.sides.end()) return;
    if (*highest <= std::numeric_limits<std::uint8_t>::max())
        smooth_with<std::uint8_t>(mesh, rounds, threads);
    else if (*highest <= std::numeric_limits<std::uint16_t>::max())
        smooth_with<std::uint16_t>(mesh, rounds, threads);
    else
        smooth_with<std::uint32_t>(mesh, rounds, threads);
}

template <class Coordinate>
void smooth(Coordinate* vertices, std::size_t vertex_count, const std::int32_t* triangles, std::size_t triangle_count,
            int rounds, int threads) {
    if (rounds <= 0) return;
    std::vector<Element> elements(vertex_count, 0);
    for (std::size_t n = 0; n < 3 * vertex_count; ++n) {
        const bool inside = vertices[n] != std::floor(vertices[n]);
        elements[n / 3] = static_cast<Element>(elements[n / 3] | (inside ? 1u << n % 3 : 0u));
    }
    Places places = places_of(vertices, vertex_count, threads);
    run({elements, {triangles, 3 * triangle_count}, true}, {}, rounds, threads, places);
    write_back(places, elements, vertices, threads);
}

template void smooth(float*, std::size_t, const std::int32_t*, std::size_t, int, int);
template void smooth(double*, std::size_t, const std::int32_t*, std::size_t, int, int);

}  // namespace isocore::labels
