// measure.cpp - Two sweeps: over triangles for area and volume, over vertices for everything topological.
// The second one reads each vertex's link from its corners, so an edge is never looked up anywhere: both its ends
// see it completely.
#include "surface/measure.hpp"

#include <algorithm>
#include <bit>
#include <vector>

#include "common/parallel.hpp"
#include "surface/components.hpp"
#include "surface/corners.hpp"
#include "surface/link.hpp"
#include "surface/ring.hpp"
#include "surface/size.hpp"

namespace isocore {
namespace {

// What is counted in one window of vertices.
struct Topology {
    EdgeCounts ends;
    std::size_t corners = 0;
    std::size_t used_vertices = 0;
    std::size_t nonmanifold_vertices = 0;
    std::size_t joins = 0;                 // that joined two components into one
    std::vector<Components::Pair> across;  // to be joined with a vertex of an earlier window
};

// Joins a vertex with an earlier one of the same window; leaves one of another window for later.
void join(Components::Pair pair, std::int32_t window_begin, Components& components, Topology& sum) {
    if (pair.second >= window_begin) {
        sum.joins += components.join(pair);
    } else {
        sum.across.push_back(pair);
    }
}

void inspect_link(const Link& link, std::int32_t vertex, std::int32_t window_begin, LinkInspector& inspector,
                  Components& components, Topology& sum) {
    sum.corners += link.size();
    sum.nonmanifold_vertices += !inspector.inspect(link, sum.ends);
    for (const auto& edge : link) {
        if (edge.from < 0) join({vertex, vertex + edge.from}, window_begin, components, sum);
        if (edge.to < 0) join({vertex, vertex + edge.to}, window_begin, components, sum);
    }
}

// Joins a vertex with its earlier neighbours. Neighbours that follow each other in the ring share an edge, which joins
// them already, so the first of each run of earlier ones is enough.
template <class Offset>
void join_ring(const Slots<Offset>& ring, std::uint32_t run_starts, std::int32_t vertex, std::int32_t window_begin,
               Components& components, Topology& sum) {
    for (; run_starts != 0; run_starts &= run_starts - 1) {
        const std::int32_t offset = ring.edges[static_cast<std::size_t>(std::countr_zero(run_starts))].to;
        join({vertex, vertex + offset}, window_begin, components, sum);
    }
}

template <class Offset>
Topology inspect_window(const Corners<Offset>& corners, std::size_t begin, std::size_t end, Components& components) {
    Topology sum;
    Link link;
    LinkInspector inspector;
    std::size_t plain_corners = 0, hanging = 0, used = 0;
    const auto window_begin = static_cast<std::int32_t>(begin);
    for (std::size_t v = begin; v < end; ++v) {
        const std::size_t count = corners.count(v);
        if (count == 0) continue;
        ++used;
        const auto self = static_cast<std::int32_t>(v);
        const Slots<Offset>& slots = corners.slots(v);
        if (!is_plain_ring(slots, count)) {
            corners.copy_link(v, link);
            inspect_link(link, self, window_begin, inspector, components, sum);
            continue;
        }
        plain_corners += count;
        const std::uint32_t starts = starts_of_earlier_runs(slots, count);
        if (starts == 0) continue;
        const std::int32_t first = self + slots.edges[static_cast<std::size_t>(std::countr_zero(starts))].to;
        if (first >= window_begin) {
            components.hang_below(self, first);
            ++hanging;
        } else {
            sum.across.emplace_back(self, first);
        }
        join_ring(slots, starts & (starts - 1), self, window_begin, components, sum);  // nearly always none
    }
    sum.used_vertices = used;
    sum.joins += hanging;
    sum.corners += plain_corners;
    sum.ends.edges += plain_corners;
    return sum;
}

void add_window(const Topology& window, Components& components, Topology& sum) {
    sum.ends.edges += window.ends.edges;
    sum.ends.boundary += window.ends.boundary;
    sum.ends.nonmanifold += window.ends.nonmanifold;
    sum.ends.misoriented += window.ends.misoriented;
    sum.corners += window.corners;
    sum.used_vertices += window.used_vertices;
    sum.nonmanifold_vertices += window.nonmanifold_vertices;
    sum.joins += window.joins;
    for (const Components::Pair& pair : window.across) sum.joins += components.join(pair);
}

template <class Offset, class Real>
Topology inspect_vertices(const MeshView<Real>& mesh, const std::vector<VertexRange>& ranges, int threads) {
    const std::size_t size = window_size(ranges, mesh.vertex_count, threads);
    const std::size_t count = (mesh.vertex_count + size - 1) / size;
    const std::size_t workers = std::min(count, static_cast<std::size_t>(std::max(threads, 1)));
    Components components(mesh.vertex_count);
    std::vector<Topology> windows(count);
    parallel_for(threads, workers, [&](std::size_t worker) {
        Corners<Offset> corners(mesh.triangles, mesh.triangle_count, ranges);
        for (std::size_t window = worker; window < count; window += workers) {
            const std::size_t begin = window * size, end = std::min(mesh.vertex_count, begin + size);
            components.start(begin, end);
            corners.look_at(begin, end);
            windows[window] = inspect_window(corners, begin, end, components);
        }
    });
    Topology sum;
    for (const Topology& window : windows) add_window(window, components, sum);
    return sum;
}

}  // namespace

template <class Real>
Measured measure(const MeshView<Real>& mesh, int threads) {
    Measured measured;
    const Size size = size_of(mesh, threads);
    measured.bounds = size.bounds;
    measured.area = size.doubled_area / 2;
    measured.volume = size.sixfold_volume / 6;
    measured.degenerate = size.degenerate;

    const Topology topology = has_short_ranges(size.ranges)
                                  ? inspect_vertices<std::int16_t>(mesh, size.ranges, threads)
                                  : inspect_vertices<std::int32_t>(mesh, size.ranges, threads);
    measured.components = topology.used_vertices - topology.joins;
    measured.edges = topology.ends.edges / 2;  // here and below: both ends have counted it
    measured.boundary_edges = topology.ends.boundary / 2;
    measured.nonmanifold_edges = topology.ends.nonmanifold / 2;
    measured.misoriented_edges = topology.ends.misoriented / 2;
    measured.nonmanifold_vertices = topology.nonmanifold_vertices;
    measured.used_vertices = topology.used_vertices;
    measured.euler = static_cast<std::ptrdiff_t>(measured.used_vertices) - static_cast<std::ptrdiff_t>(measured.edges) +
                     static_cast<std::ptrdiff_t>(topology.corners / 3);
    return measured;
}

template Measured measure(const MeshView<float>&, int);
template Measured measure(const MeshView<double>&, int);

}  // namespace isocore
