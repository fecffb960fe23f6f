// grid_propagate.cpp - Isosurface propagation through the cells of a volume (mesh/propagate.cpp says how), drawn with
// the cases and decisions of marching cubes, so that the triangles are the same.
//
// Every crossed edge has one owner: the cell whose lowest corner it starts at, or the nearest one where the volume
// ends. All cells around a crossed edge are visited, the owner with them, so a vertex's number is its owner's first
// number plus the owned crossings before it, without a hash.
#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "common/crossing.hpp"
#include "common/cube.hpp"
#include "common/mesh_cells.hpp"
#include "common/parallel.hpp"
#include "samples/decider.hpp"
#include "samples/sample_types.hpp"
#include "tables/cell_loops.hpp"
#include "thinning/grid/grid_thinning.hpp"
#include "thinning/grid/padded_grid.hpp"
#include "thinning/range_lookup.hpp"

namespace isocore::thinning {
namespace {

using mesh::Hex;
using mesh::Mask;
using std::int32_t;
using std::size_t;

constexpr size_t kChunk = 4096;

template <class Sample>
class GridWalk {
  public:
    GridWalk(const PaddedGrid<Sample>& grid, const GridSkeletonView& skeleton, double isovalue)
        : grid_(grid), skeleton_(skeleton), inside_(isovalue, grid.below) {}
    // Takes the marks of the visited cells back, also where drawing them has thrown.
    ~GridWalk() {
        for (const int32_t cell : cells) skeleton_.place[cell] = 0;
    }
    GridWalk(const GridWalk&) = delete;
    GridWalk& operator=(const GridWalk&) = delete;

    void run(double isovalue) {
        const double height = grid_.below ? -isovalue : isovalue;
        RangeLookup(skeleton_.low, skeleton_.high, skeleton_.size).find(height, [&](size_t n) {
            ++seeds;
            visit(skeleton_.cells[n]);
        });
        for (size_t head = 0; head < cells.size(); ++head) step(cells[head]);
    }

    Array<int32_t> cells;
    Array<std::uint8_t> signs;  // of their corners
    size_t seeds = 0;

  private:
    void visit(int32_t cell) {
        int32_t& place = skeleton_.place[cell];
        if (place != 0) return;
        cells.push_back(cell);
        place = static_cast<int32_t>(cells.size());
    }

    bool inside(const Dims& at) const { return !(grid_.pad && grid_.is_padding(at)) && inside_(grid_.sample(at)); }

    void step(int32_t cell) {
        const Dims at = grid_.cell_at(static_cast<size_t>(cell));
        Mask mask = 0;
        for (size_t corner = 0; corner < 8; ++corner) {
            mask |= Mask{inside({at[0] + (corner & 1), at[1] + (corner >> 1 & 1), at[2] + (corner >> 2)})} << corner;
        }
        signs.push_back(static_cast<std::uint8_t>(mask));
        const std::array<size_t, 3> steps{1, grid_.cells[0], grid_.cells[0] * grid_.cells[1]};
        for (Mask left = mesh::kCrossedFaces<Hex>[mask]; left != 0; left &= left - 1) {
            const auto face = static_cast<size_t>(std::countr_zero(left)), axis = face / 2;
            const bool up = face & 1;
            if (up ? at[axis] + 1 == grid_.cells[axis] : at[axis] == 0) continue;
            visit(cell + (up ? static_cast<int32_t>(steps[axis]) : -static_cast<int32_t>(steps[axis])));
        }
    }

    const PaddedGrid<Sample>& grid_;
    const GridSkeletonView& skeleton_;
    Inside<Sample> inside_;
};

// For every set of axes along which a cell is the last one: the edges it owns.
constexpr std::array<Mask, 8> kOwned = [] {
    std::array<Mask, 8> owned{};
    for (Mask last = 0; last < 8; ++last) {
        for (std::size_t edge = 0; edge < 12; ++edge) {
            if ((Hex::kShape.ends[edge][0] & ~last) == 0) owned[last] |= Mask{1} << edge;
        }
    }
    return owned;
}();

template <class Sample>
class GridDrawing {
  public:
    GridDrawing(const PaddedGrid<Sample>& grid, const GridWalk<Sample>& walk, const int32_t* place, double isovalue)
        : grid_(grid),
          walk_(walk),
          place_(place),
          isovalue_(isovalue),
          first_vertex_(walk.cells.size() + 1),
          chunks_((walk.cells.size() + kChunk - 1) / kChunk) {
        for (size_t axis = 0; axis < 3; ++axis)
            step_[axis] = static_cast<int32_t>(axis == 0   ? 1
                                               : axis == 1 ? grid.cells[0]
                                                           : grid.cells[0] * grid.cells[1]);
    }

    // Numbers the vertices and places the chunks; then draws.
    GridMesh run(int threads) {
        GridMesh mesh;
        parallel_for(threads, chunks_.size(), [&](size_t chunk) { count(chunk); });
        size_t vertices = 0, corners = 0;
        for (Chunk& chunk : chunks_) {
            vertices += std::exchange(chunk.vertex, vertices);
            corners += std::exchange(chunk.corner, corners);
            mesh.ambiguous_cells += chunk.ambiguous_cells;
            mesh.ambiguous_faces += chunk.ambiguous_faces;
        }
        if (vertices > static_cast<size_t>(std::numeric_limits<int32_t>::max())) {
            throw std::length_error(
                "the surface has more vertices than 2^31 - 1; crop the volume or choose another isovalue");
        }
        mesh.vertices.resize(3 * vertices);
        mesh.triangles.resize(corners);
        parallel_for(threads, chunks_.size(), [&](size_t chunk) { place_vertices(chunk, mesh); });
        parallel_for(threads, chunks_.size(), [&](size_t chunk) { draw(chunk, mesh); });
        return mesh;
    }

  private:
    struct Chunk {
        size_t vertex = 0, corner = 0, ambiguous_faces = 0, ambiguous_cells = 0;
    };

    size_t end(size_t chunk) const { return std::min(walk_.cells.size(), (chunk + 1) * kChunk); }
    Dims at(size_t n) const { return grid_.cell_at(static_cast<size_t>(walk_.cells[n])); }

    Mask last(const Dims& cell) const {
        Mask axes = 0;
        for (size_t axis = 0; axis < 3; ++axis) axes |= Mask{cell[axis] + 1 == grid_.cells[axis]} << axis;
        return axes;
    }
    Mask owned_crossings(const Dims& cell, Mask signs) const {
        return mesh::kCrossedEdges<Hex>[signs] & kOwned[last(cell)];
    }

    const cell_loops::Case& drawn(const Dims& cell, Mask signs) const {
        const cell_loops::Corners& entry = cell_loops::kTable.corners[signs];
        if (entry.ambiguous == 0) return cell_loops::kTable.cases[entry.first];
        return cell_loops::kTable.cases[entry.first + decide_faces(grid_.samples, grid_.pad, isovalue_, signs, cell)];
    }

    void count(size_t chunk) {
        Chunk& sum = chunks_[chunk];
        for (size_t n = chunk * kChunk; n < end(chunk); ++n) {
            const Dims cell = at(n);
            sum.vertex += static_cast<size_t>(std::popcount(owned_crossings(cell, walk_.signs[n])));
            sum.corner += 3u * drawn(cell, walk_.signs[n]).triangles;
            const unsigned ambiguous = cell_loops::kTable.corners[walk_.signs[n]].ambiguous;
            sum.ambiguous_cells += ambiguous != 0;
            sum.ambiguous_faces += static_cast<size_t>(std::popcount(ambiguous));
        }
    }

    void place_vertices(size_t chunk, GridMesh& out) {
        size_t vertex = chunks_[chunk].vertex;
        for (size_t n = chunk * kChunk; n < end(chunk); ++n) {
            const Dims cell = at(n);
            first_vertex_[n] = static_cast<int32_t>(vertex);
            for (Mask left = owned_crossings(cell, walk_.signs[n]); left != 0; left &= left - 1, ++vertex) {
                write_vertex(cell, static_cast<size_t>(std::countr_zero(left)), out.vertices.data() + 3 * vertex);
            }
        }
    }

    // Places the vertex as samples/sample_reader.cpp does for marching cubes, so that its bytes are the same.
    void write_vertex(const Dims& cell, size_t edge, double* out) const {
        const size_t corner = Hex::kShape.ends[edge][0], axis = edge / 4;
        const Dims from{cell[0] + (corner & 1), cell[1] + (corner >> 1 & 1), cell[2] + (corner >> 2)};
        Dims to = from;
        ++to[axis];
        const double t = grid_.pad && grid_.is_padding(from) ? 1 - kClamp
                         : grid_.pad && grid_.is_padding(to)
                             ? kClamp
                             : crossing(grid_.sample(from), grid_.sample(to), isovalue_);
        for (size_t n = 0; n < 3; ++n) out[n] = static_cast<double>(from[n]) - static_cast<double>(grid_.pad);
        out[axis] += t;
    }

    // The number of the vertex on a crossed edge. Its owner is the cell one step up along every axis on which the edge
    // lies at this cell's high side, except where there is no further cell.
    int32_t vertex_on(size_t n, const Dims& cell, Mask last_axes, size_t edge) const {
        const Mask up = Hex::kShape.ends[edge][0] & ~last_axes;
        if (up == 0) return numbered(n, cell, edge);
        Dims there = cell;
        int32_t owner = walk_.cells[n];
        for (size_t axis = 0; axis < 3; ++axis) {
            if (!(up >> axis & 1)) continue;
            ++there[axis];
            owner += step_[axis];
        }
        const auto corner = static_cast<int>(Hex::kShape.ends[edge][0] & ~up), axis = static_cast<int>(edge / 4);
        return numbered(static_cast<size_t>(place_[owner]) - 1, there,
                        static_cast<size_t>(cube::edge_between(corner, corner | 1 << axis)));
    }

    int32_t numbered(size_t n, const Dims& cell, size_t edge) const {
        const Mask before = owned_crossings(cell, walk_.signs[n]) & ((Mask{1} << edge) - 1);
        return first_vertex_[n] + std::popcount(before);
    }

    void draw(size_t chunk, GridMesh& drawn_mesh) const {
        int32_t* out = drawn_mesh.triangles.data() + chunks_[chunk].corner;
        std::array<int32_t, 12> vertex;
        for (size_t n = chunk * kChunk; n < end(chunk); ++n) {
            const Dims cell = at(n);
            const Mask last_axes = last(cell);
            for (Mask left = mesh::kCrossedEdges<Hex>[walk_.signs[n]]; left != 0; left &= left - 1) {
                const auto edge = static_cast<size_t>(std::countr_zero(left));
                vertex[edge] = vertex_on(n, cell, last_axes, edge);
            }
            const cell_loops::Case& shape = drawn(cell, walk_.signs[n]);
            for (size_t corner = 0; corner < 3u * shape.triangles; ++corner) *out++ = vertex[shape.edges[corner]];
        }
    }

    const PaddedGrid<Sample>& grid_;
    const GridWalk<Sample>& walk_;
    const int32_t* place_;
    double isovalue_;
    Array<int32_t> first_vertex_;
    std::array<int32_t, 3> step_;
    std::vector<Chunk> chunks_;
};

}  // namespace

template <class Sample>
GridMesh propagate_grid(GridView<Sample> samples, const GridSkeletonView& skeleton, double isovalue,
                        const GridOptions& options, int threads) {
    const PaddedGrid<Sample> grid(samples, options);
    GridWalk<Sample> walk(grid, skeleton, isovalue);
    walk.run(isovalue);
    GridMesh mesh = GridDrawing<Sample>(grid, walk, skeleton.place, isovalue).run(threads);
    mesh.seeds = walk.seeds;
    mesh.visited = walk.cells.size();
    return mesh;
}

#define ISOCORE_INSTANTIATE(Sample)                                                                                 \
    template GridMesh propagate_grid<Sample>(GridView<Sample>, const GridSkeletonView&, double, const GridOptions&, \
                                             int);
ISOCORE_FOR_EACH_SAMPLE_TYPE(ISOCORE_INSTANTIATE)
#undef ISOCORE_INSTANTIATE

}  // namespace isocore::thinning
