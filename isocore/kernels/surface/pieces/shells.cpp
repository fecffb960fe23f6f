// shells.cpp - Vertices are joined along triangles; then two sweeps, over vertices for what is open, over triangles for
// what adds up.
#include "surface/pieces/shells.hpp"

#include <algorithm>
#include <cmath>

#include "common/parallel.hpp"
#include "surface/components.hpp"
#include "surface/corners.hpp"
#include "surface/ring.hpp"
#include "surface/size.hpp"

namespace isocore {
namespace {

// Numbers the shells by their first vertices.
template <class Real>
Shells numbered(const MeshView<Real>& mesh) {
    Components components(mesh.vertex_count);
    components.start(0, mesh.vertex_count);
    Shells found;
    found.of_vertex.assign(mesh.vertex_count, -1);
    for (std::size_t t = 0; t < mesh.triangle_count; ++t) {
        const std::int32_t* corners = mesh.triangles + 3 * t;
        components.join({corners[0], corners[1]});
        components.join({corners[0], corners[2]});
        for (std::size_t n = 0; n < 3; ++n) found.of_vertex[static_cast<std::size_t>(corners[n])] = 0;
    }
    for (std::size_t v = 0; v < mesh.vertex_count; ++v) {
        if (found.of_vertex[v] < 0) continue;
        const std::int32_t root = components.root_of(static_cast<std::int32_t>(v));
        if (static_cast<std::size_t>(root) == v) {
            found.of_vertex[v] = static_cast<std::int32_t>(found.shells.size());
            found.shells.push_back({.first = root});
        } else {
            found.of_vertex[v] = found.of_vertex[static_cast<std::size_t>(root)];  // the root is earlier
        }
    }
    return found;
}

// Does some edge at a vertex have more triangles one way than the other? uses: scratch memory.
bool has_loose_edge(const Link& link, std::vector<std::pair<std::int32_t, int>>& uses) {
    uses.clear();
    for (const auto& edge : link) {
        uses.emplace_back(edge.from, 1);
        uses.emplace_back(edge.to, -1);
    }
    std::sort(uses.begin(), uses.end());
    for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
        int balance = 0;
        for (end = begin; end < uses.size() && uses[end].first == uses[begin].first; ++end) balance += uses[end].second;
        if (balance != 0) return true;
    }
    return false;
}

template <class Real>
void find_open(const MeshView<Real>& mesh, int threads, Shells& found) {
    const std::vector<VertexRange> ranges = ranges_of(mesh, threads);
    const std::size_t size = window_size(ranges, mesh.vertex_count, threads);
    const std::size_t count = (mesh.vertex_count + size - 1) / size;
    const std::size_t workers = std::min(count, static_cast<std::size_t>(std::max(threads, 1)));
    std::vector<std::vector<std::size_t>> loose(count);  // vertices, by window
    parallel_for(threads, workers, [&](std::size_t worker) {
        Corners<std::int32_t> corners(mesh.triangles, mesh.triangle_count, ranges);
        Link link;
        std::vector<std::pair<std::int32_t, int>> uses;
        for (std::size_t window = worker; window < count; window += workers) {
            const std::size_t begin = window * size, end = std::min(mesh.vertex_count, begin + size);
            corners.look_at(begin, end);
            for (std::size_t v = begin; v < end; ++v) {
                const std::size_t degree = corners.count(v);
                if (degree == 0 || is_plain_ring(corners.slots(v), degree)) continue;
                corners.copy_link(v, link);
                if (has_loose_edge(link, uses)) loose[window].push_back(v);
            }
        }
    });
    for (const auto& window : loose) {
        for (const std::size_t v : window) found.shells[static_cast<std::size_t>(found.of_vertex[v])].closed = false;
    }
}

// Volumes are those of tetrahedra at the shell's first vertex, so that digits are not lost far from the origin.
template <class Real>
void add_up(const MeshView<Real>& mesh, Shells& found) {
    for (std::size_t t = 0; t < mesh.triangle_count; ++t) {
        const std::int32_t* corners = mesh.triangles + 3 * t;
        const auto number = static_cast<std::size_t>(found.of_vertex[static_cast<std::size_t>(corners[0])]);
        Shell& shell = found.shells[number];
        const Vec3 normal = doubled_area(mesh, corners);
        shell.triangles += 1;
        shell.area += std::sqrt(dot(normal, normal)) / 2;
        shell.volume += dot(normal, mesh.vertex(corners[0]) - mesh.vertex(shell.first)) / 6;
    }
}

}  // namespace

template <class Real>
Shells shells_of(const MeshView<Real>& mesh, int threads) {
    check_indices(mesh.triangles, mesh.triangle_count, mesh.vertex_count);
    if (mesh.triangle_count == 0) {
        Shells none;
        none.of_vertex.assign(mesh.vertex_count, -1);
        return none;
    }
    Shells found = numbered(mesh);
    find_open(mesh, threads, found);
    add_up(mesh, found);
    return found;
}

template Shells shells_of(const MeshView<float>&, int);
template Shells shells_of(const MeshView<double>&, int);

}  // namespace isocore
