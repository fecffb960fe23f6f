// propagate.cpp - Isosurface propagation: from the skeleton cells that hold the isovalue, breadth first through the
// faces that the isosurface crosses. On signs only, never on geometry: a face is crossed iff its corners differ in
// sign, and then both of its cells are. What was visited is drawn block by block, in the order of the cells' numbers,
// whoever walked.
//
// Numbering vertices needs no hash: every edge has one owner among its cells, and all cells around a crossed edge are
// visited, the owner with them. So the owners number and place the vertices first, and then the triangles find them.
// An index out of a file that lies may name other owners or lack seeds: a number that no vertex has is refused.
#include <algorithm>
#include <atomic>
#include <bit>
#include <limits>
#include <stdexcept>
#include <vector>

#include "common/collapsed.hpp"
#include "common/parallel.hpp"
#include "thinning/mesh/thinning.hpp"
#include "thinning/mesh/walk.hpp"

namespace isocore::thinning {
namespace {

using mesh::Field;
using mesh::Hex;
using mesh::Mask;
using mesh::Tet;
using std::int32_t;
using std::size_t;

template <class Cell, class Value>
class Drawing {
  public:
    // Gives every block of a walk its place in the output: a prefix sum that starts at `before`, and is left there.
    Drawing(const Walk<Cell, Value>& walk, const Field<Value>& field, const IndexView& index, double isovalue,
            Amount& before)
        : walk_(walk), field_(field), index_(index), isovalue_(isovalue) {
        size_t cells = 0;
        for (size_t block = 0; block < walk.blocks().size(); ++block) {
            const Amount& drawn = walk.blocks()[block];
            if (drawn.cells == 0) continue;
            tasks_.push_back({block, cells, drawn.cells, before});
            cells += drawn.cells;
            before += drawn;
        }
        cells_.resize(cells);
        signs_.resize(cells);
    }

    size_t tasks() const { return tasks_.size(); }
    const Array<int32_t>& cells() const { return cells_; }

    // The cells of a block, in order.
    void collect(size_t task) {
        int32_t* out = cells_.data() + tasks_[task].first;
        walk_.for_each_visited(tasks_[task].block, [&](int32_t cell) { *out++ = cell; });
    }

    // Numbers the vertices that the cells of a block own, and places them.
    template <class Coordinate>
    void place_vertices(size_t task, Mesh<Coordinate>& mesh) {
        collect(task);
        size_t vertex = tasks_[task].before.vertices;
        const bool with_edges = !mesh.edges.empty();
        const auto prefetch = [&](size_t, const int32_t* corners) {
            for (size_t n = 0; n < Cell::kCorners; ++n) {
                ISOCORE_PREFETCH(field_.values + corners[n]);
                ISOCORE_PREFETCH(field_.point(corners[n]));
            }
        };
        for_each(task, prefetch, [&](size_t n, const int32_t* corners) {
            const Mask signs = walk_.signs(corners);
            signs_[n] = static_cast<std::uint8_t>(signs);
            for (Mask left = walk_.owned(corners, signs); left != 0; left &= left - 1, ++vertex) {
                const auto edge = static_cast<size_t>(std::countr_zero(left));
                const int32_t a = corners[Cell::kShape.ends[edge][0]], b = corners[Cell::kShape.ends[edge][1]];
                const bool ascending = index_.points[a] < index_.points[b];
                field_.cross(ascending ? a : b, ascending ? b : a, isovalue_, mesh.vertices.data() + 3 * vertex);
                if (with_edges) {
                    mesh.edges[2 * vertex] = index_.points[ascending ? a : b];
                    mesh.edges[2 * vertex + 1] = index_.points[ascending ? b : a];
                }
                vertex_on(corners, edge) = static_cast<int32_t>(vertex);
            }
        });
    }

    // first_middle: the number of the first vertex in the middle of a loop. Returns whether a triangle has two equal
    // corners.
    template <class Coordinate>
    bool draw(size_t task, size_t first_middle, Mesh<Coordinate>& mesh) const {
        int32_t* out = mesh.triangles.data() + 3 * tasks_[task].before.triangles;
        size_t middle = first_middle + tasks_[task].before.middles;
        bool collapsed = false;
        const auto prefetch = [&](size_t n, const int32_t* corners) {
            for (Mask left = mesh::kCrossedEdges<Cell>[signs_[n]]; left != 0; left &= left - 1) {
                ISOCORE_PREFETCH(&vertex_on(corners, static_cast<size_t>(std::countr_zero(left))));
            }
        };
        for_each(task, prefetch, [&](size_t n, const int32_t* corners) {
            const auto& drawn = walk_.drawn(corners, signs_[n]);
            bool numbered = true;
            for (size_t corner = 0; corner < 3u * drawn.triangles; ++corner) {
                const size_t edge = drawn.edges[corner];
                out[corner] = edge < mesh::kMiddle ? vertex_on(corners, edge)
                                                   : static_cast<int32_t>(middle + edge - mesh::kMiddle);
                numbered &= edge >= mesh::kMiddle || static_cast<size_t>(out[corner]) < first_middle;
            }
            if (!numbered) throw std::invalid_argument("the owner of a crossed edge is not among the cells visited");
            for (size_t triangle = 0; triangle < drawn.triangles; ++triangle, out += 3) {
                collapsed |= out[0] == out[1] || out[1] == out[2] || out[2] == out[0];
            }
            const auto position = [&](size_t edge) {
                return mesh.vertices.data() + 3 * static_cast<size_t>(vertex_on(corners, edge));
            };
            mesh::write_middles(drawn, position, mesh.vertices.data() + 3 * middle);
            middle += drawn.middles;
        });
        return collapsed;
    }

  private:
    struct Task {
        size_t block, first, cells;  // first: place of its first cell among those visited
        Amount before;
    };

    // Calls visit(place, record) for the visited cells of a block, in order, and prefetch(place, record) some cells
    // ahead of it.
    template <class Prefetch, class Visit>
    void for_each(size_t task, const Prefetch& prefetch, const Visit& visit) const {
        constexpr size_t kRecordsAhead = 12, kValuesAhead = 6;
        const size_t end = tasks_[task].first + tasks_[task].cells;
        for (size_t n = tasks_[task].first; n < end; ++n) {
            if (n + kRecordsAhead < end) walk_.prefetch_record(cells_[n + kRecordsAhead]);
            if (n + kValuesAhead < end) prefetch(n + kValuesAhead, walk_.record(cells_[n + kValuesAhead]));
            visit(n, walk_.record(cells_[n]));
        }
    }

    int32_t& vertex_on(const int32_t* corners, size_t edge) const {
        const int32_t id = corners[Cell::kCorners + Cell::kFaces + edge];
        return index_.vertex_of_edge[id < 0 ? ~id : id];
    }

    const Walk<Cell, Value>& walk_;
    const Field<Value>& field_;
    const IndexView& index_;
    double isovalue_;
    Array<int32_t> cells_;
    Array<std::uint8_t> signs_;
    std::vector<Task> tasks_;
};

}  // namespace

template <class Coordinate, class Value>
Mesh<Coordinate> propagate(const Field<Value>& field, const IndexView& index, double isovalue, int threads,
                           bool with_edges) {
    Walk<Tet, Value> tets(field, index.tets, isovalue);
    Walk<Hex, Value> hexes(field, index.hexes, isovalue);
    tets.run(threads);
    hexes.run(threads);
    Amount all;
    Drawing<Tet, Value> drawn_tets(tets, field, index, isovalue, all);
    Drawing<Hex, Value> drawn_hexes(hexes, field, index, isovalue, all);
    if (all.vertices + all.middles > static_cast<size_t>(std::numeric_limits<int32_t>::max())) {
        throw std::length_error("the surface has more vertices than 2^31 - 1; choose another isovalue");
    }
    Mesh<Coordinate> mesh;
    mesh.vertices.resize(3 * (all.vertices + all.middles));
    mesh.triangles.resize(3 * all.triangles);
    mesh.edges.resize(with_edges ? 2 * all.vertices : 0);
    const size_t tasks = drawn_tets.tasks();
    parallel_for(threads, tasks + drawn_hexes.tasks(), [&](size_t task) {
        task < tasks ? drawn_tets.place_vertices(task, mesh) : drawn_hexes.place_vertices(task - tasks, mesh);
    });
    std::atomic<bool> collapsed{false};
    parallel_for(threads, tasks + drawn_hexes.tasks(), [&](size_t task) {
        if (task < tasks ? drawn_tets.draw(task, all.vertices, mesh)
                         : drawn_hexes.draw(task - tasks, all.vertices, mesh))
            collapsed = true;
    });
    if (collapsed) drop_collapsed(mesh.triangles);
    mesh.seeds = tets.seeds() + hexes.seeds();
    mesh.visited = all.cells;
    return mesh;
}

template <class Value>
Visited walk(const Field<Value>& field, const IndexView& index, double isovalue) {
    Walk<Tet, Value> tets(field, index.tets, isovalue);
    Walk<Hex, Value> hexes(field, index.hexes, isovalue);
    Visited visited;
    const auto search = [&](auto& part, Array<int32_t>& cells) {
        part.run(1);
        for (size_t block = 0; block < part.blocks().size(); ++block) {
            part.for_each_visited(block, [&](int32_t cell) { cells.push_back(cell); });
        }
        visited.seeds += part.seeds();
    };
    search(tets, visited.tets);
    search(hexes, visited.hexes);
    return visited;
}

template Visited walk<float>(const Field<float>&, const IndexView&, double);
template Visited walk<double>(const Field<double>&, const IndexView&, double);
template Mesh<float> propagate<float>(const Field<float>&, const IndexView&, double, int, bool);
template Mesh<float> propagate<float>(const Field<double>&, const IndexView&, double, int, bool);
template Mesh<double> propagate<double>(const Field<float>&, const IndexView&, double, int, bool);
template Mesh<double> propagate<double>(const Field<double>&, const IndexView&, double, int, bool);

}  // namespace isocore::thinning
