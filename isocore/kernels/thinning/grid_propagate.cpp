// grid_propagate.cpp - Isosurface propagation through the cells of a volume (propagate.cpp says how), drawn with the cases and
// decisions of marching cubes, so that the triangles are the same.
#include <algorithm>
#include <array>
#include <bit>
#include <vector>

#include "common/cell_loops.hpp"
#include "common/crossing.hpp"
#include "common/decider.hpp"
#include "common/edge_merger.hpp"
#include "common/mesh_cells.hpp"
#include "common/parallel.hpp"
#include "thinning/grid_thinning.hpp"
#include "thinning/padded_grid.hpp"
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

    void run(double isovalue) {
        const double height = grid_.below ? -isovalue : isovalue;
        RangeLookup(skeleton_.low, skeleton_.high, skeleton_.size).find(height, [&](size_t n) {
            ++seeds;
            visit(skeleton_.cells[n]);
        });
        for (size_t head = 0; head < cells.size(); ++head) step(cells[head]);
    }

    void forget() {
        for (const int32_t cell : cells) skeleton_.visited[cell] = 0;
    }

    Array<int32_t> cells;
    Array<std::uint8_t> signs;  // of their corners
    size_t seeds = 0;

  private:
    void visit(int32_t cell) {
        std::uint8_t& visited = skeleton_.visited[cell];
        if (visited) return;
        visited = 1;
        cells.push_back(cell);
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

// What a chunk of visited cells draws; the triangles' corners are places among its edges.
struct Drawn {
    Array<Edge> edges;
    Array<std::uint32_t> triangles;
    size_t ambiguous_faces = 0, ambiguous_cells = 0;
};

template <class Sample>
void draw(const PaddedGrid<Sample>& grid, int32_t cell, Mask signs, double isovalue, Drawn& out) {
    const Dims at = grid.cell_at(static_cast<size_t>(cell));
    const cell_loops::Corners& entry = cell_loops::kTable.corners[signs];
    unsigned decided = 0;
    if (entry.ambiguous != 0) {
        ++out.ambiguous_cells;
        out.ambiguous_faces += static_cast<size_t>(std::popcount(unsigned{entry.ambiguous}));
        decided = decide_faces(grid.samples, grid.pad, isovalue, signs, at);
    }
    const cell_loops::Case& drawn = cell_loops::kTable.cases[entry.first + decided];
    const size_t low = grid.id(at);
    const auto id = [&](size_t corner) { return static_cast<int32_t>(low + (corner & 1) + (corner >> 1 & 1) * grid.step(1) + (corner >> 2) * grid.step(2)); };
    std::array<std::uint32_t, 12> place;
    for (Mask left = mesh::kCrossedEdges<Hex>[signs]; left != 0; left &= left - 1) {
        const auto edge = static_cast<size_t>(std::countr_zero(left));
        place[edge] = static_cast<std::uint32_t>(out.edges.size());
        out.edges.push_back({id(Hex::kShape.ends[edge][0]), id(Hex::kShape.ends[edge][1])});
    }
    for (size_t n = 0; n < 3u * drawn.triangles; ++n) out.triangles.push_back(place[drawn.edges[n]]);
}

// As edge_vertices.hpp places them, but by edge instead of by row.
template <class Sample>
void write_vertex(const PaddedGrid<Sample>& grid, const Edge& edge, double isovalue, double* out) {
    const auto low = static_cast<size_t>(edge.low), apart = static_cast<size_t>(edge.high) - low;
    const Dims at{low % grid.dims[0], low / grid.dims[0] % grid.dims[1], low / grid.dims[0] / grid.dims[1]};
    const size_t axis = apart == 1 ? 0 : apart == grid.step(1) ? 1 : 2;
    Dims next = at;
    ++next[axis];
    const double t = grid.pad && grid.is_padding(at)     ? 1 - kClamp
                     : grid.pad && grid.is_padding(next) ? kClamp
                                                         : crossing(grid.sample(at), grid.sample(next), isovalue);
    for (size_t n = 0; n < 3; ++n) out[n] = static_cast<double>(at[n]) - static_cast<double>(grid.pad);
    out[axis] += t;
}

}  // namespace

template <class Sample>
GridMesh propagate_grid(GridView<Sample> samples, const GridSkeletonView& skeleton, double isovalue, const GridOptions& options, int threads) {
    const PaddedGrid<Sample> grid(samples, options);
    GridWalk<Sample> walk(grid, skeleton, isovalue);
    walk.run(isovalue);
    std::vector<Drawn> drawn((walk.cells.size() + kChunk - 1) / kChunk);
    parallel_for(threads, drawn.size(), [&](size_t chunk) {
        const size_t end = std::min(walk.cells.size(), (chunk + 1) * kChunk);
        for (size_t n = chunk * kChunk; n < end; ++n) draw(grid, walk.cells[n], walk.signs[n], isovalue, drawn[chunk]);
    });
    walk.forget();
    std::vector<Array<Edge>> seen(drawn.size());
    std::vector<size_t> first_edge(drawn.size() + 1), first_corner(drawn.size() + 1);
    for (size_t n = 0; n < drawn.size(); ++n) {
        first_edge[n + 1] = first_edge[n] + drawn[n].edges.size();
        first_corner[n + 1] = first_corner[n] + drawn[n].triangles.size();
        seen[n] = std::move(drawn[n].edges);
    }
    const Merged merged = merge_edges(seen, grid.size(), threads);
    GridMesh mesh;
    mesh.vertices.resize(3 * merged.edges.size());
    mesh.triangles.resize(first_corner.back());
    parallel_for(threads, merged.edges.size() / kChunk + 1, [&](size_t chunk) {
        const size_t end = std::min(merged.edges.size(), (chunk + 1) * kChunk);
        for (size_t n = chunk * kChunk; n < end; ++n) write_vertex(grid, merged.edges[n], isovalue, mesh.vertices.data() + 3 * n);
    });
    parallel_for(threads, drawn.size(), [&](size_t chunk) {
        int32_t* out = mesh.triangles.data() + first_corner[chunk];
        for (const std::uint32_t place : drawn[chunk].triangles) *out++ = merged.vertex_of[first_edge[chunk] + place];
    });
    mesh.seeds = walk.seeds;
    mesh.visited = walk.cells.size();
    for (const Drawn& chunk : drawn) {
        mesh.ambiguous_faces += chunk.ambiguous_faces;
        mesh.ambiguous_cells += chunk.ambiguous_cells;
    }
    return mesh;
}

#define ISOCORE_INSTANTIATE(Sample) \
    template GridMesh propagate_grid<Sample>(GridView<Sample>, const GridSkeletonView&, double, const GridOptions&, int);
ISOCORE_INSTANTIATE(std::uint8_t)
ISOCORE_INSTANTIATE(std::int8_t)
ISOCORE_INSTANTIATE(std::uint16_t)
ISOCORE_INSTANTIATE(std::int16_t)
ISOCORE_INSTANTIATE(std::uint32_t)
ISOCORE_INSTANTIATE(std::int32_t)
ISOCORE_INSTANTIATE(float)
ISOCORE_INSTANTIATE(double)
#undef ISOCORE_INSTANTIATE

}  // namespace isocore::thinning
