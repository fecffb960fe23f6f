// measure.cpp - Two sweeps: over triangles for area and volume, over vertices for everything topological.
// The second one reads each vertex's link from the flat corner list, so an edge is never looked up anywhere:
// both its ends see it completely.
#include "surface/measure.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "common/parallel.hpp"
#include "surface/components.hpp"
#include "surface/corners.hpp"
#include "surface/link.hpp"

namespace isocore {
namespace {

// Sums are rounded block by block, so this number is part of the result.
constexpr std::size_t kBlock = 8192;

std::size_t block_count(std::size_t items) { return (items + kBlock - 1) / kBlock; }
std::size_t block_end(std::size_t block, std::size_t items) { return std::min(items, (block + 1) * kBlock); }

struct Extent {
    double doubled_area = 0;
    double sixfold_volume = 0;
    std::size_t degenerate = 0;
};

template <class Real>
Extent sum_block(const MeshView<Real>& mesh, std::size_t block, const Vec3& centre) {
    Extent sum;
    for (std::size_t t = block * kBlock; t < block_end(block, mesh.triangle_count); ++t) {
        const std::int32_t* corners = mesh.triangles + 3 * t;
        const Vec3 normal = doubled_area(mesh, corners);
        sum.degenerate += normal[0] == 0 && normal[1] == 0 && normal[2] == 0;
        sum.doubled_area += std::sqrt(dot(normal, normal));
        sum.sixfold_volume += dot(normal, mesh.vertex(corners[0]) - centre);
    }
    return sum;
}

template <class Real>
void sum_triangles(const MeshView<Real>& mesh, int threads, Measured& out) {
    // Around the middle, so that a small body far from the origin keeps its digits.
    Vec3 centre;
    for (std::size_t axis = 0; axis < 3; ++axis) centre[axis] = 0.5 * (out.bounds[axis] + out.bounds[axis + 3]);
    std::vector<Extent> blocks(block_count(mesh.triangle_count));
    parallel_for(threads, blocks.size(), [&](std::size_t block) { blocks[block] = sum_block(mesh, block, centre); });
    Extent sum;
    for (const Extent& block : blocks) {
        sum.doubled_area += block.doubled_area;
        sum.sixfold_volume += block.sixfold_volume;
        sum.degenerate += block.degenerate;
    }
    out.area = sum.doubled_area / 2;
    out.volume = sum.sixfold_volume / 6;
    out.degenerate = sum.degenerate;
}

struct Topology {
    EdgeCounts ends;
    std::size_t used_vertices = 0;
    std::size_t nonmanifold_vertices = 0;
};

Topology inspect_block(const Corners& corners, std::size_t begin, std::size_t end, Components& components) {
    Topology sum;
    for (std::size_t v = begin; v < end; ++v) {
        const Opposite* link = corners.begin(v);
        const std::size_t count = corners.count(v);
        if (count == 0) continue;
        ++sum.used_vertices;
        const auto self = static_cast<std::int32_t>(v);
        if (is_plain_ring(link, count)) {
            sum.ends.edges += count;
            // On a ring every neighbour is the start of one link edge, and one end of an edge is enough.
            for (std::size_t i = 0; i < count; ++i) {
                if (link[i].from < self) components.join(self, link[i].from);
            }
            continue;
        }
        sum.nonmanifold_vertices += !inspect_link(link, count, sum.ends);
        for (std::size_t i = 0; i < count; ++i) {
            components.join(self, link[i].from);
            components.join(self, link[i].to);
        }
    }
    return sum;
}

template <class Real>
void inspect_vertices(const MeshView<Real>& mesh, int threads, Measured& out) {
    const Corners corners = list_corners(mesh.triangles, mesh.triangle_count, mesh.vertex_count, threads);
    Components components(mesh.vertex_count);
    std::vector<Topology> blocks(block_count(mesh.vertex_count));
    parallel_for(threads, blocks.size(), [&](std::size_t block) {
        blocks[block] = inspect_block(corners, block * kBlock, block_end(block, mesh.vertex_count), components);
    });
    for (const Topology& block : blocks) {
        out.edges += block.ends.edges;
        out.boundary_edges += block.ends.boundary;
        out.nonmanifold_edges += block.ends.nonmanifold;
        out.misoriented_edges += block.ends.misoriented;
        out.nonmanifold_vertices += block.nonmanifold_vertices;
        out.used_vertices += block.used_vertices;
    }
    for (std::size_t* both_ends : {&out.edges, &out.boundary_edges, &out.nonmanifold_edges, &out.misoriented_edges}) {
        *both_ends /= 2;
    }
    for (std::size_t v = 0; v < mesh.vertex_count; ++v) {
        out.components += corners.count(v) > 0 && components.is_root(v);
    }
    out.euler = static_cast<std::ptrdiff_t>(out.used_vertices) - static_cast<std::ptrdiff_t>(out.edges) +
                static_cast<std::ptrdiff_t>(corners.opposites.size() / 3);
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
    check_indices(mesh.triangles, mesh.triangle_count, mesh.vertex_count);
    Measured measured;
    measured.bounds = bounds(mesh.vertices, mesh.vertex_count);
    sum_triangles(mesh, threads, measured);
    inspect_vertices(mesh, threads, measured);
    return measured;
}

template std::array<double, 6> bounds(const float*, std::size_t);
template std::array<double, 6> bounds(const double*, std::size_t);
template Measured measure(const MeshView<float>&, int);
template Measured measure(const MeshView<double>&, int);

}  // namespace isocore
