// propagate.cpp - Isosurface propagation: from the skeleton cells that hold the isovalue, breadth first through the
// faces that the isosurface crosses. On signs only, never on geometry: a face is crossed iff its corners differ in
// sign, and then both of its cells are. What was visited is drawn lot by lot, in the order of the cells' numbers,
// whoever walked.
//
// The cells around an edge lie close together in that order, so a lot meets most edges as often as there are cells
// around them, and joins them in a small table of its own before the few that are left are joined with other lots'.
#include <algorithm>
#include <atomic>
#include <bit>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "common/collapsed.hpp"
#include "common/edge_merger.hpp"
#include "common/parallel.hpp"
#include "tables/mesh_cases.hpp"
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
using std::uint32_t;

constexpr size_t kLot = 1024, kChunk = 8192;  // cells, vertices

// What a lot of cells draws. A triangle's corners are places among the lot's edges, or, from kMiddles on, middles of
// loops.
struct Drawn {
    static constexpr uint32_t kMiddles = uint32_t{1} << 31;
    Array<MeshEdge> edges;
    Array<uint32_t> triangles;
    std::vector<std::array<uint32_t, 2>> middles;  // the triangles around each: first, end
};

// The edges of one lot by their points: a slot names a place among them, so that all stays in the fastest cache.
class EdgeTable {
  public:
    void start(size_t cells) {
        slots_.assign(std::bit_ceil(4 * cells), 0);
        edges_.resize(kEdgesPerCell * cells);
        count_ = 0;
    }

    // The edge's place, from 0 on; a new edge gets the next one.
    uint32_t place(int32_t a, int32_t b) {
        const MeshEdge edge{std::min(a, b), std::max(a, b)};
        Number& slot = find(edge);
        if (slot != 0) return slot - uint32_t{1};
        edges_[count_] = edge;
        slot = static_cast<Number>(++count_);
        if (2 * count_ > slots_.size()) grow();
        return static_cast<uint32_t>(count_ - 1);
    }

    Array<MeshEdge> edges() const { return {edges_.begin(), edges_.begin() + static_cast<std::ptrdiff_t>(count_)}; }

  private:
    static constexpr size_t kEdgesPerCell = 12;  // at most, of a cell
    using Number = std::uint16_t;
    static_assert(kLot * kEdgesPerCell < std::numeric_limits<Number>::max());

    // The slot of an edge, or an empty one for it.
    Number& find(const MeshEdge& edge) {
        const std::uint64_t both =
            std::uint64_t{static_cast<uint32_t>(edge.high)} << 32 | static_cast<uint32_t>(edge.low);
        const size_t mask = slots_.size() - 1;
        size_t n = both * std::uint64_t{0x9e3779b97f4a7c15} >> 40 & mask;
        for (; slots_[n] != 0; n = (n + 1) & mask) {
            const MeshEdge& there = edges_[slots_[n] - size_t{1}];
            if (there.low == edge.low && there.high == edge.high) break;
        }
        return slots_[n];
    }

    void grow() {
        slots_.assign(2 * slots_.size(), 0);
        for (size_t n = 0; n < count_; ++n) find(edges_[n]) = static_cast<Number>(n + 1);
    }

    Array<Number> slots_;  // 0: empty, else 1 more than the place
    Array<MeshEdge> edges_;
    size_t count_ = 0;
};

// Draws the visited cells of one kind.
template <class Cell, class Value>
class Drawing {
  public:
    Drawing(const Field<Value>& field, const PartView& part, double isovalue, int threads)
        : walk_(field, part, isovalue), field_(field), isovalue_(isovalue) {
        walk_.run(threads);
        cells_ = walk_.visited_cells();
    }

    size_t seeds() const { return walk_.seeds(); }
    const Array<int32_t>& cells() const { return cells_; }
    size_t lots() const { return (cells_.size() + kLot - 1) / kLot; }

    Drawn draw(size_t lot, EdgeTable& table) const {
        constexpr size_t kRecordsAhead = 12, kValuesAhead = 6;
        Drawn out;
        const size_t end = std::min(cells_.size(), (lot + 1) * kLot);
        out.triangles.reserve(6 * (end - lot * kLot));
        table.start(end - lot * kLot);
        for (size_t n = lot * kLot; n < end; ++n) {
            if (n + kRecordsAhead < end) walk_.prefetch_record(cells_[n + kRecordsAhead]);
            if (n + kValuesAhead < end) walk_.prefetch_values(cells_[n + kValuesAhead]);
            draw_cell(walk_.record(cells_[n]), table, out);
        }
        out.edges = table.edges();
        return out;
    }

  private:
    void draw_cell(const int32_t* corners, EdgeTable& table, Drawn& out) const {
        const Mask signs = walk_.signs(corners);
        const auto& drawn = mesh::drawn(
            Cell{}, signs, [&](size_t n) { return static_cast<double>(field_.value(corners[n])); }, isovalue_);
        std::array<uint32_t, Cell::kEdges> place;
        for (Mask left = mesh::kCrossedEdges<Cell>[signs]; left != 0; left &= left - 1) {
            const auto edge = static_cast<size_t>(std::countr_zero(left));
            const auto& ends = Cell::kShape.ends[edge];
            place[edge] = table.place(corners[ends[0]], corners[ends[1]]);
        }
        const size_t first = out.triangles.size(), size = 3u * drawn.triangles;
        out.triangles.resize(first + size);
        uint32_t* triangles = out.triangles.data() + first;
        if (drawn.middles > 0) return draw_around_middles(drawn, place, triangles, out);
        for (size_t n = 0; n < size; ++n) triangles[n] = place[drawn.edges[n]];
    }

    template <class Case, class Edges>
    static void draw_around_middles(const Case& drawn, const Edges& place, uint32_t* triangles, Drawn& out) {
        const auto first_triangle = static_cast<uint32_t>((triangles - out.triangles.data()) / 3),
                   first_middle = static_cast<uint32_t>(out.middles.size());
        out.middles.resize(first_middle + drawn.middles, {0, 0});
        for (uint32_t n = 0; n < 3u * drawn.triangles; ++n) {
            const size_t edge = drawn.edges[n];
            if (edge < mesh::kMiddle) {
                triangles[n] = place[edge];
                continue;
            }
            const auto middle = first_middle + static_cast<uint32_t>(edge - mesh::kMiddle);
            const uint32_t triangle = first_triangle + n / 3;
            if (out.middles[middle][1] == 0) out.middles[middle][0] = triangle;
            out.middles[middle][1] = triangle + 1;
            triangles[n] = Drawn::kMiddles + middle;
        }
    }

    Walk<Cell, Value> walk_;
    const Field<Value>& field_;
    double isovalue_;
    Array<int32_t> cells_;
};

// Where the lots' edges, triangles and middles begin among all.
struct Places {
    size_t edge = 0, triangle = 0, middle = 0;
};

std::vector<Places> places_of(const std::vector<Drawn>& drawn, const std::vector<Array<MeshEdge>>& edges) {
    std::vector<Places> places(drawn.size() + 1);
    for (size_t n = 0; n < drawn.size(); ++n) {
        places[n + 1] = {places[n].edge + edges[n].size(), places[n].triangle + drawn[n].triangles.size(),
                         places[n].middle + drawn[n].middles.size()};
    }
    return places;
}

// Places the vertices of a chunk of edges.
template <class Coordinate, class Value>
void place_vertices(const Field<Value>& field, const IndexView& index, double isovalue, const Merged& merged,
                    size_t chunk, bool with_edges, Mesh<Coordinate>& mesh) {
    const size_t end = std::min(merged.edges.size(), (chunk + 1) * kChunk);
    for (size_t n = chunk * kChunk; n < end; ++n) {
        const auto [low, high] = merged.edges[n];
        const int32_t a = index.points[low], b = index.points[high];
        field.cross(a < b ? low : high, a < b ? high : low, isovalue, mesh.vertices.data() + 3 * n);
        if (!with_edges) continue;
        mesh.edges[2 * n] = std::min(a, b);
        mesh.edges[2 * n + 1] = std::max(a, b);
    }
}

// Turns a lot's places into vertices. first_middle: the number of its first vertex in the middle of a loop. Returns
// whether a triangle has two equal corners.
template <class Coordinate>
bool join(const Drawn& from, const int32_t* vertex_of, size_t first_middle, int32_t* out, Mesh<Coordinate>& mesh) {
    bool collapsed = false;
    for (size_t n = 0; n < from.triangles.size(); ++n) {
        const uint32_t corner = from.triangles[n];
        out[n] = corner < Drawn::kMiddles ? vertex_of[corner]
                                          : static_cast<int32_t>(first_middle + (corner - Drawn::kMiddles));
        if (n % 3 == 2) collapsed |= out[n] == out[n - 1] || out[n] == out[n - 2] || out[n - 1] == out[n - 2];
    }
    for (size_t n = 0; n < from.middles.size(); ++n) {
        std::array<double, 3> sum{};  // over the first corner of each triangle around: the corners of the loop
        const auto [first, end] = from.middles[n];
        for (uint32_t triangle = first; triangle < end; ++triangle) {
            const Coordinate* corner = mesh.vertices.data() + 3 * static_cast<size_t>(out[3 * triangle]);
            for (size_t axis = 0; axis < 3; ++axis) sum[axis] += static_cast<double>(corner[axis]);
        }
        for (size_t axis = 0; axis < 3; ++axis)
            mesh.vertices[3 * (first_middle + n) + axis] = static_cast<Coordinate>(sum[axis] / (end - first));
    }
    return collapsed;
}

}  // namespace

template <class Coordinate, class Value>
Mesh<Coordinate> propagate(const Field<Value>& field, const IndexView& index, double isovalue, int threads,
                           bool with_edges) {
    const Drawing<Tet, Value> tets(field, index.tets, isovalue, threads);
    const Drawing<Hex, Value> hexes(field, index.hexes, isovalue, threads);
    std::vector<Drawn> drawn(tets.lots() + hexes.lots());
    std::vector<Array<MeshEdge>> edges(drawn.size());
    parallel_for(
        threads, drawn.size(), [] { return EdgeTable(); },
        [&](EdgeTable& table, size_t lot) {
            drawn[lot] = lot < tets.lots() ? tets.draw(lot, table) : hexes.draw(lot - tets.lots(), table);
            edges[lot] = std::move(drawn[lot].edges);
        });
    const Merged merged = merge_edges(edges, field.size, threads);
    const std::vector<Places> places = places_of(drawn, edges);
    const size_t on_edges = merged.edges.size(), all = on_edges + places.back().middle;
    if (all > static_cast<size_t>(std::numeric_limits<int32_t>::max())) {
        throw std::length_error("the surface has more vertices than 2^31 - 1; choose another isovalue");
    }
    Mesh<Coordinate> mesh;
    mesh.vertices.resize(3 * all);
    mesh.triangles.resize(places.back().triangle);
    mesh.edges.resize(with_edges ? 2 * on_edges : 0);
    parallel_for(threads, on_edges / kChunk + 1,
                 [&](size_t chunk) { place_vertices(field, index, isovalue, merged, chunk, with_edges, mesh); });
    std::atomic<bool> collapsed{false};
    parallel_for(threads, drawn.size(), [&](size_t lot) {
        if (join(drawn[lot], merged.vertex_of.data() + places[lot].edge, on_edges + places[lot].middle,
                 mesh.triangles.data() + places[lot].triangle, mesh))
            collapsed = true;
    });
    if (collapsed) drop_collapsed(mesh.triangles);
    mesh.seeds = tets.seeds() + hexes.seeds();
    mesh.visited = tets.cells().size() + hexes.cells().size();
    return mesh;
}

template <class Value>
Visited walk(const Field<Value>& field, const IndexView& index, double isovalue) {
    Visited visited;
    const auto search = [&](auto&& part) {
        part.run(1);
        visited.seeds += part.seeds();
        return part.visited_cells();
    };
    visited.tets = search(Walk<Tet, Value>(field, index.tets, isovalue));
    visited.hexes = search(Walk<Hex, Value>(field, index.hexes, isovalue));
    return visited;
}

template Visited walk<float>(const Field<float>&, const IndexView&, double);
template Visited walk<double>(const Field<double>&, const IndexView&, double);
template Mesh<float> propagate<float>(const Field<float>&, const IndexView&, double, int, bool);
template Mesh<float> propagate<float>(const Field<double>&, const IndexView&, double, int, bool);
template Mesh<double> propagate<double>(const Field<float>&, const IndexView&, double, int, bool);
template Mesh<double> propagate<double>(const Field<double>&, const IndexView&, double, int, bool);

}  // namespace isocore::thinning
