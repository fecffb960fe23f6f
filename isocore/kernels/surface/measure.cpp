// measure.cpp - Two sweeps: over triangles for area and volume, over vertices for everything topological.
// The second one reads each vertex's link from the sorted corners, so an edge is never looked up anywhere: both
// its ends see it completely.
#include "surface/measure.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "common/parallel.hpp"
#include "surface/components.hpp"
#include "surface/corners.hpp"
#include "surface/link.hpp"
#include "surface/ring.hpp"

namespace isocore {
namespace {

// What one block of triangles adds. Sums are rounded block by block, so the block's size is part of the result.
struct Extent {
    double doubled_area = 0;
    double sixfold_volume = 0;
    std::size_t degenerate = 0;
};

template <class Real>
Extent sum_block(const MeshView<Real>& mesh, std::size_t begin, std::size_t end, const Vec3& centre) {
    Extent sum;
    for (std::size_t t = begin; t < end; ++t) {
        const std::int32_t* corners = mesh.triangles + 3 * t;
        const Vec3 normal = doubled_area(mesh, corners);
        sum.degenerate += normal[0] == 0 && normal[1] == 0 && normal[2] == 0;
        sum.doubled_area += std::sqrt(dot(normal, normal));
        sum.sixfold_volume += dot(normal, mesh.vertex(corners[0]) - centre);
    }
    return sum;
}

VertexRange range_of(const std::int32_t* begin, const std::int32_t* end) {
    VertexRange range{*begin, *begin};
    for (const std::int32_t* corner = begin; corner != end; ++corner) {
        range.lowest = std::min(range.lowest, *corner);
        range.highest = std::max(range.highest, *corner);
    }
    return range;
}

template <class Real>
std::vector<VertexRange> sum_triangles(const MeshView<Real>& mesh, int threads, Measured& out) {
    // Around the middle, so that a small body far from the origin keeps its digits.
    Vec3 centre;
    for (std::size_t axis = 0; axis < 3; ++axis) centre[axis] = 0.5 * (out.bounds[axis] + out.bounds[axis + 3]);
    const std::size_t count = (mesh.triangle_count + kTrianglesPerBlock - 1) / kTrianglesPerBlock;
    std::vector<Extent> extents(count);
    std::vector<VertexRange> ranges(count);
    parallel_for(threads, count, [&](std::size_t block) {
        const std::size_t begin = block * kTrianglesPerBlock;
        const std::size_t end = std::min(mesh.triangle_count, begin + kTrianglesPerBlock);
        ranges[block] = range_of(mesh.triangles + 3 * begin, mesh.triangles + 3 * end);
        if (ranges[block].lowest < 0 || static_cast<std::size_t>(ranges[block].highest) >= mesh.vertex_count) {
            throw std::invalid_argument("a triangle names a vertex that does not exist");
        }
        extents[block] = sum_block(mesh, begin, end, centre);
    });
    Extent sum;
    for (const Extent& extent : extents) {
        sum.doubled_area += extent.doubled_area;
        sum.sixfold_volume += extent.sixfold_volume;
        sum.degenerate += extent.degenerate;
    }
    out.area = sum.doubled_area / 2;
    out.volume = sum.sixfold_volume / 6;
    out.degenerate = sum.degenerate;
    return ranges;
}

struct Topology {
    EdgeCounts ends;
    std::size_t corners = 0;
    std::size_t used_vertices = 0;
    std::size_t nonmanifold_vertices = 0;
    std::size_t first_vertices = 0;  // without an earlier neighbour
    std::vector<Components::Pair> to_join;
};

// Hangs a vertex below one earlier neighbour and leaves the others to be joined. On a ring, neighbours that follow
// each other are joined by the edge between them, so one of each run of earlier neighbours is enough.
void hang_on_ring(const Slots& ring, std::size_t count, std::int32_t middle, Components& components, Topology& sum) {
    std::uint32_t starts = starts_of_earlier_runs(ring, count, middle);
    const auto next = [&] {
        const auto i = static_cast<std::size_t>(std::countr_zero(starts));
        starts &= starts - 1;
        return ring.to[i];
    };
    if (starts == 0) {
        ++sum.first_vertices;
        return;
    }
    components.hang_below(middle, next());
    while (starts != 0) sum.to_join.emplace_back(middle, next());
}

void hang_anywhere(const std::vector<LinkEdge>& link, std::int32_t middle, Components& components, Topology& sum) {
    bool hangs = false;
    for (const LinkEdge& edge : link) {
        for (const std::int32_t neighbour : {edge.from, edge.to}) {
            if (neighbour > middle) continue;
            if (hangs) sum.to_join.emplace_back(middle, neighbour);
            if (!hangs) components.hang_below(middle, neighbour);
            hangs = true;
        }
    }
    sum.first_vertices += !hangs;
}

Topology inspect_window(const Corners& corners, std::size_t begin, std::size_t end, Components& components) {
    Topology sum;
    std::vector<LinkEdge> link;
    LinkInspector inspector;
    for (std::size_t v = begin; v < end; ++v) {
        const std::size_t count = corners.count(v);
        if (count == 0) continue;
        const auto self = static_cast<std::int32_t>(v);
        const Slots& slots = corners.slots(v);
        sum.corners += count;
        ++sum.used_vertices;
        if (is_plain_ring(slots, count)) {
            sum.ends.edges += count;
            hang_on_ring(slots, count, self, components, sum);
        } else {
            corners.copy_link(v, link);
            sum.nonmanifold_vertices += !inspector.inspect(link, sum.ends);
            hang_anywhere(link, self, components, sum);
        }
    }
    return sum;
}

template <class Real>
void inspect_vertices(const MeshView<Real>& mesh, const std::vector<VertexRange>& ranges, int threads, Measured& out) {
    const std::size_t size = window_size(ranges, mesh.vertex_count, threads);
    const std::size_t count = (mesh.vertex_count + size - 1) / size;
    const std::size_t workers = std::min(count, static_cast<std::size_t>(std::max(threads, 1)));
    Components components(mesh.vertex_count);
    std::vector<Topology> windows(count);
    parallel_for(threads, workers, [&](std::size_t worker) {
        Corners corners(mesh.triangles, mesh.triangle_count, ranges);
        for (std::size_t window = worker; window < count; window += workers) {
            const std::size_t begin = window * size, end = std::min(mesh.vertex_count, begin + size);
            corners.look_at(begin, end);
            windows[window] = inspect_window(corners, begin, end, components);
        }
    });
    std::size_t corner_count = 0;
    for (const Topology& window : windows) {
        corner_count += window.corners;
        out.edges += window.ends.edges;
        out.boundary_edges += window.ends.boundary;
        out.nonmanifold_edges += window.ends.nonmanifold;
        out.misoriented_edges += window.ends.misoriented;
        out.nonmanifold_vertices += window.nonmanifold_vertices;
        out.used_vertices += window.used_vertices;
        out.components += window.first_vertices;
        for (const Components::Pair& pair : window.to_join) out.components -= components.join(pair);
    }
    for (std::size_t* both_ends : {&out.edges, &out.boundary_edges, &out.nonmanifold_edges, &out.misoriented_edges}) {
        *both_ends /= 2;
    }
    out.euler = static_cast<std::ptrdiff_t>(out.used_vertices) - static_cast<std::ptrdiff_t>(out.edges) +
                static_cast<std::ptrdiff_t>(corner_count / 3);
}

}  // namespace

template <class Real>
std::array<double, 6> bounds(const Real* vertices, std::size_t count) {
    std::array<Real, 3> low, high;
    low.fill(std::numeric_limits<Real>::infinity());
    high.fill(-std::numeric_limits<Real>::infinity());
    for (std::size_t v = 0; v < count; ++v) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const Real x = vertices[3 * v + axis];
            low[axis] = x < low[axis] ? x : low[axis];
            high[axis] = x > high[axis] ? x : high[axis];
        }
    }
    std::array<double, 6> found{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (!(low[axis] <= high[axis])) continue;
        found[axis] = static_cast<double>(low[axis]);
        found[axis + 3] = static_cast<double>(high[axis]);
    }
    return found;
}

template <class Real>
Measured measure(const MeshView<Real>& mesh, int threads) {
    Measured measured;
    measured.bounds = bounds(mesh.vertices, mesh.vertex_count);
    const std::vector<VertexRange> ranges = sum_triangles(mesh, threads, measured);
    inspect_vertices(mesh, ranges, threads, measured);
    return measured;
}

template std::array<double, 6> bounds(const float*, std::size_t);
template std::array<double, 6> bounds(const double*, std::size_t);
template Measured measure(const MeshView<float>&, int);
template Measured measure(const MeshView<double>&, int);

}  // namespace isocore
