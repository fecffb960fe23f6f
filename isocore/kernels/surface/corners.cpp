// corners.cpp - A counting sort of corners by vertex. Each thread takes one run of triangles and counts for
// itself, so that nobody has to wait for anybody; the places then follow from all counts.
#include "surface/corners.hpp"

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "common/parallel.hpp"

namespace isocore {
namespace {

// Each run costs one counter per vertex, so more threads than this cost more memory than they save time.
constexpr int kMaxRuns = 8;

bool repeats_a_corner(const std::int32_t* t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

template <class Visit>
void for_each_corner(const std::int32_t* triangles, std::size_t begin, std::size_t end, const Visit& visit) {
    for (std::size_t t = begin; t < end; ++t) {
        const std::int32_t* corners = triangles + 3 * t;
        if (repeats_a_corner(corners)) continue;
        visit(corners[0], corners[1], corners[2]);
        visit(corners[1], corners[2], corners[0]);
        visit(corners[2], corners[0], corners[1]);
    }
}

}  // namespace

Corners list_corners(const std::int32_t* triangles, std::size_t triangle_count, std::size_t vertex_count,
                     int threads) {
    if (triangle_count > UINT32_MAX / 3) throw std::invalid_argument("more than 1.4 billion triangles");
    const auto runs = static_cast<std::size_t>(std::clamp(threads, 1, kMaxRuns));
    const auto run_begin = [&](std::size_t run) { return triangle_count * run / runs; };
    std::vector<Array<std::uint32_t>> place(runs);
    parallel_for(threads, runs, [&](std::size_t run) {
        place[run].assign(vertex_count, 0);
        for_each_corner(triangles, run_begin(run), run_begin(run + 1),
                        [counts = place[run].data()](std::int32_t v, std::int32_t, std::int32_t) { ++counts[v]; });
    });

    Corners corners;
    corners.first.resize(vertex_count + 1);
    std::uint32_t total = 0;
    for (std::size_t v = 0; v < vertex_count; ++v) {
        corners.first[v] = total;
        for (std::size_t run = 0; run < runs; ++run) {
            const std::uint32_t count = place[run][v];
            place[run][v] = total;
            total += count;
        }
    }
    corners.first[vertex_count] = total;

    corners.opposites.resize(total);
    parallel_for(threads, runs, [&](std::size_t run) {
        for_each_corner(triangles, run_begin(run), run_begin(run + 1),
                        [next = place[run].data(), to = corners.opposites.data()](
                            std::int32_t v, std::int32_t a, std::int32_t b) { to[next[v]++] = {a, b}; });
    });
    return corners;
}

}  // namespace isocore
