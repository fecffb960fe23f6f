// shells.cpp - Two sweeps, as in measure.cpp: over vertices for what hangs together and what is open, from their links,
// and over triangles for what adds up.
#include "surface/pieces/shells.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "common/parallel.hpp"
#include "surface/components.hpp"
#include "surface/corners.hpp"
#include "surface/ring.hpp"
#include "surface/size.hpp"

namespace isocore {
namespace {

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

// What one window of vertices has to say.
struct Window {
    std::vector<std::size_t> loose;        // vertices with a loose edge
    std::vector<Components::Pair> across;  // to be joined with a vertex of an earlier window
};

// Joins every vertex of a window with its earlier neighbours. used: 0 for those that have a triangle, else -1.
template <class Offset>
Window look_through(const Corners<Offset>& corners, std::size_t begin, std::size_t end, Components& components,
                    Array<std::int32_t>& used) {
    Window found;
    Link link;
    std::vector<std::pair<std::int32_t, int>> uses;
    for (std::size_t v = begin; v < end; ++v) {
        const auto self = static_cast<std::int32_t>(v);
        const auto join = [&](std::int32_t offset) {
            const bool is_here = self + offset >= static_cast<std::int32_t>(begin);
            if (is_here && !components.are_close(self, self + offset)) components.join({self, self + offset});
            if (!is_here) found.across.emplace_back(self, self + offset);
        };
        const std::size_t degree = corners.count(v);
        used[v] = degree == 0 ? -1 : 0;
        if (degree == 0) continue;
        const Slots<Offset>& slots = corners.slots(v);
        if (is_plain_ring(slots, degree)) {  // neighbours that follow each other in the ring share an edge themselves
            for (std::uint32_t runs = starts_of_earlier_runs(slots, degree); runs != 0; runs &= runs - 1) {
                join(slots.edges[static_cast<std::size_t>(std::countr_zero(runs))].to);
            }
            continue;
        }
        corners.copy_link(v, link);
        for (const auto& edge : link) {
            if (edge.from < 0) join(edge.from);
            if (edge.to < 0) join(edge.to);
        }
        if (has_loose_edge(link, uses)) found.loose.push_back(v);
    }
    return found;
}

// Gives every vertex that is used its shell, by first vertices.
void number(Components& components, Shells& found) {
    for (std::size_t v = 0; v < found.of_vertex.size(); ++v) {
        if (found.of_vertex[v] < 0) continue;
        const std::int32_t root = components.root_of(static_cast<std::int32_t>(v));
        if (static_cast<std::size_t>(root) == v) {
            found.of_vertex[v] = static_cast<std::int32_t>(found.shells.size());
            found.shells.push_back({.first = root});
        } else {
            found.of_vertex[v] = found.of_vertex[static_cast<std::size_t>(root)];  // the root is earlier
        }
    }
}

template <class Offset, class Real>
Shells joined(const MeshView<Real>& mesh, const std::vector<VertexRange>& ranges, int threads) {
    const std::size_t size = window_size(ranges, mesh.vertex_count, threads);
    const std::size_t count = (mesh.vertex_count + size - 1) / size;
    const std::size_t workers = std::min(count, static_cast<std::size_t>(std::max(threads, 1)));
    Components components(mesh.vertex_count);
    Shells found;
    found.of_vertex.resize(mesh.vertex_count);
    std::vector<Window> windows(count);
    parallel_for(threads, workers, [&](std::size_t worker) {
        Corners<Offset> corners(mesh.triangles, mesh.triangle_count, ranges);
        for (std::size_t window = worker; window < count; window += workers) {
            const std::size_t begin = window * size, end = std::min(mesh.vertex_count, begin + size);
            components.start(begin, end);
            corners.look_at(begin, end);
            windows[window] = look_through(corners, begin, end, components, found.of_vertex);
        }
    });
    for (const Window& window : windows) {
        for (const Components::Pair& pair : window.across) components.join(pair);
    }
    number(components, found);
    for (const Window& window : windows) {
        for (const std::size_t v : window.loose) {
            found.shells[static_cast<std::size_t>(found.of_vertex[v])].closed = false;
        }
    }
    return found;
}

// Volumes are those of tetrahedra at the shell's first vertex, so that digits are not lost far from the origin.
template <class Real>
void add_up(const MeshView<Real>& mesh, Shells& found) {
    for (std::size_t t = 0; t < mesh.triangle_count; ++t) {
        const std::int32_t* corners = mesh.triangles + 3 * t;
        if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
        const std::int32_t number = found.of_vertex[static_cast<std::size_t>(corners[0])];
        Shell& shell = found.shells[static_cast<std::size_t>(number)];
        const Vec3 normal = doubled_area(mesh, corners);
        shell.triangles += 1;
        shell.area += std::sqrt(dot(normal, normal)) / 2;
        shell.volume += dot(normal, mesh.vertex(corners[0]) - mesh.vertex(shell.first)) / 6;
    }
}

}  // namespace

template <class Real>
Shells shells_of(const MeshView<Real>& mesh, int threads) {
    const std::vector<VertexRange> ranges = ranges_of(mesh, threads);  // checks what triangles name
    Shells found = has_short_ranges(ranges) ? joined<std::int16_t>(mesh, ranges, threads)
                                            : joined<std::int32_t>(mesh, ranges, threads);
    add_up(mesh, found);
    return found;
}

template Shells shells_of(const MeshView<float>&, int);
template Shells shells_of(const MeshView<double>&, int);

}  // namespace isocore
