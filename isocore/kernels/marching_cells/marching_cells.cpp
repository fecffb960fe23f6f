// marching_cells.cpp - A full scan of a mesh.
//
// Tetrahedra: A. Doi, A. Koide, "An Efficient Method of Triangulating Equi-Valued Surfaces by Using Tetrahedral Cells",
// IEICE Transactions E74(1), 1991. Hexahedra: W. Lorensen, H. Cline, "Marching Cubes", SIGGRAPH 1987, with the
// asymptotic decider of G. Nielson, B. Hamann, Visualization 1991. Every sign is computed once per point, every chunk
// of cells is scanned for itself, and the crossed edges are merged by sorting, so threads need no locks.
#include "marching_cells/marching_cells.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <stdexcept>
#include <vector>

#include "common/collapsed.hpp"
#include "common/edge_merger.hpp"
#include "common/parallel.hpp"
#include "tables/mesh_cases.hpp"

namespace isocore::marching_cells {
namespace {

using mesh::CornerIds;
using mesh::Field;
using mesh::Hex;
using mesh::Tet;

constexpr std::size_t kChunk = 32768;

template <class Value>
Array<std::uint8_t> classify(const Field<Value>& field, double isovalue, int threads) {
    const Inside<Value> inside(isovalue, false);
    Array<std::uint8_t> signs(field.size);
    parallel_for(threads, field.size / kChunk + 1, [&](std::size_t chunk) {
        const std::size_t end = std::min(field.size, (chunk + 1) * kChunk);
        for (std::size_t id = chunk * kChunk; id < end; ++id) signs[id] = inside(field.values[id]);
    });
    return signs;
}

// What one chunk of cells draws. A triangle's corners are places among the edges the chunk has seen, or, from kMiddles
// on, middles of loops.
struct Drawn {
    static constexpr std::uint32_t kMiddles = std::uint32_t{1} << 31;
    Array<MeshEdge> edges;
    Array<std::uint32_t> triangles;
    std::vector<std::array<std::uint32_t, 2>> middles;  // the triangles around each: first, end
    std::size_t intersected = 0;
};

template <class Cell, class Value>
void draw_cell(const Field<Value>& field, const std::int32_t* corners, const std::uint8_t* signs, double isovalue,
               Drawn& out) {
    const CornerIds<Cell> ids = mesh::upright<Cell>(field, corners);
    mesh::Mask mask = 0;
    for (std::size_t n = 0; n < Cell::kCorners; ++n) mask |= static_cast<mesh::Mask>(signs[ids[n]]) << n;
    const auto& drawn =
        mesh::drawn(Cell{}, mask, [&](std::size_t n) { return static_cast<double>(field.value(ids[n])); }, isovalue);
    std::array<std::uint32_t, Cell::kEdges> place;
    for (mesh::Mask left = mesh::kCrossedEdges<Cell>[mask]; left != 0; left &= left - 1) {
        const auto edge = static_cast<std::size_t>(std::countr_zero(left));
        const auto& ends = Cell::kShape.ends[edge];
        const std::int32_t a = ids[ends[0]], b = ids[ends[1]];
        place[edge] = static_cast<std::uint32_t>(out.edges.size());
        out.edges.push_back({std::min(a, b), std::max(a, b)});
    }
    const auto first_middle = static_cast<std::uint32_t>(out.middles.size());
    out.middles.resize(first_middle + drawn.middles, {0, 0});
    for (std::size_t n = 0; n < 3u * drawn.triangles; ++n) {
        const std::size_t edge = drawn.edges[n];
        if (edge < mesh::kMiddle) {
            out.triangles.push_back(place[edge]);
            continue;
        }
        const auto middle = first_middle + static_cast<std::uint32_t>(edge - mesh::kMiddle);
        const auto triangle = static_cast<std::uint32_t>(out.triangles.size() / 3);
        if (out.middles[middle][1] == 0) out.middles[middle][0] = triangle;
        out.middles[middle][1] = triangle + 1;
        out.triangles.push_back(Drawn::kMiddles + middle);
    }
    ++out.intersected;
}

template <class Cell, class Value>
Drawn draw_chunk(const Field<Value>& field, const std::int32_t* cells, std::size_t count, const std::uint8_t* signs,
                 double isovalue) {
    Array<std::uint32_t> active(count);
    std::size_t found = 0;
    for (std::size_t cell = 0; cell < count; ++cell) {
        const std::int32_t* ids = cells + Cell::kCorners * cell;
        unsigned inside = 0;
        for (std::size_t n = 0; n < Cell::kCorners; ++n) inside += signs[ids[n]];
        active[found] = static_cast<std::uint32_t>(cell);
        found += inside - 1 <
                 Cell::kCorners - 1;  // some corners are inside, not all; no branch, which would be mispredicted
    }
    Drawn out;
    out.edges.reserve(4 * found);
    out.triangles.reserve(6 * found);
    for (std::size_t n = 0; n < found; ++n)
        draw_cell<Cell>(field, cells + Cell::kCorners * active[n], signs, isovalue, out);
    return out;
}

// The second half of the work, chunk by chunk: turns places among a chunk's edges into the mesh's vertices.
template <class Coordinate>
class Joiner {
  public:
    Joiner(std::vector<Drawn>& drawn, const Merged& merged, Mesh<Coordinate>& mesh)
        : drawn_(drawn), merged_(merged), mesh_(mesh), places_(drawn.size()) {
        std::size_t edge = 0, triangle = 0, middle = merged.edges.size();
        for (std::size_t n = 0; n < drawn.size(); ++n) {
            places_[n] = {edge, triangle, middle};
            edge += drawn[n].edges.size();
            triangle += drawn[n].triangles.size();
            middle += drawn[n].middles.size();
        }
        if (middle > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
            throw std::length_error("the surface has more vertices than 2^31 - 1; choose another isovalue");
        }
        mesh.vertices.resize(3 * middle);
        mesh.triangles.resize(triangle);
    }

    void join(std::size_t chunk) {
        const Drawn& from = drawn_[chunk];
        const Places& place = places_[chunk];
        const std::int32_t* vertex_of = merged_.vertex_of.data() + place.edge;
        const auto vertex = [&](std::uint32_t corner) {
            return corner < Drawn::kMiddles ? vertex_of[corner]
                                            : static_cast<std::int32_t>(place.middle + (corner - Drawn::kMiddles));
        };
        std::int32_t* out = mesh_.triangles.data() + place.triangle;
        for (std::size_t n = 0; n < from.triangles.size(); ++n) out[n] = vertex(from.triangles[n]);
        for (std::size_t n = 0; n < from.middles.size(); ++n) {
            // The first corner of each triangle around the middle is one corner of the loop.
            std::array<double, 3> sum{};
            for (std::uint32_t triangle = from.middles[n][0]; triangle < from.middles[n][1]; ++triangle) {
                const Coordinate* corner = mesh_.vertices.data() + 3 * static_cast<std::size_t>(out[3 * triangle]);
                for (std::size_t axis = 0; axis < 3; ++axis) sum[axis] += static_cast<double>(corner[axis]);
            }
            for (std::size_t axis = 0; axis < 3; ++axis) {
                mesh_.vertices[3 * (place.middle + n) + axis] =
                    static_cast<Coordinate>(sum[axis] / (from.middles[n][1] - from.middles[n][0]));
            }
        }
    }

  private:
    struct Places {
        std::size_t edge, triangle, middle;
    };
    std::vector<Drawn>& drawn_;
    const Merged& merged_;
    Mesh<Coordinate>& mesh_;
    std::vector<Places> places_;
};

}  // namespace

template <class Coordinate, class Value>
Mesh<Coordinate> march(const Field<Value>& field, const Cells& cells, double isovalue, int threads, bool with_edges) {
    const Array<std::uint8_t> signs = classify(field, isovalue, threads);
    const std::size_t tet_chunks = (cells.tet_count + kChunk - 1) / kChunk,
                      hex_chunks = (cells.hex_count + kChunk - 1) / kChunk;
    std::vector<Drawn> drawn(tet_chunks + hex_chunks);
    parallel_for(threads, drawn.size(), [&](std::size_t chunk) {
        const bool tets = chunk < tet_chunks;
        const std::size_t first = kChunk * (tets ? chunk : chunk - tet_chunks);
        const std::size_t count = std::min(kChunk, (tets ? cells.tet_count : cells.hex_count) - first);
        drawn[chunk] = tets
                           ? draw_chunk<Tet>(field, cells.tets + Tet::kCorners * first, count, signs.data(), isovalue)
                           : draw_chunk<Hex>(field, cells.hexes + Hex::kCorners * first, count, signs.data(), isovalue);
    });
    std::vector<Array<MeshEdge>> seen(drawn.size());
    for (std::size_t n = 0; n < drawn.size(); ++n) seen[n] = std::move(drawn[n].edges);
    const Merged merged = merge_edges(seen, field.size, threads);
    for (std::size_t n = 0; n < drawn.size(); ++n) drawn[n].edges = std::move(seen[n]);

    Mesh<Coordinate> mesh;
    Joiner joiner(drawn, merged, mesh);
    const std::size_t vertices = merged.edges.size();
    mesh.edges.resize(with_edges ? 2 * vertices : 0);
    parallel_for(threads, vertices / kChunk + 1, [&](std::size_t chunk) {
        const std::size_t end = std::min(vertices, (chunk + 1) * kChunk);
        for (std::size_t n = chunk * kChunk; n < end; ++n)
            field.cross(merged.edges[n].low, merged.edges[n].high, isovalue, mesh.vertices.data() + 3 * n);
        for (std::size_t n = chunk * kChunk; with_edges && n < end; ++n) {
            mesh.edges[2 * n] = merged.edges[n].low;
            mesh.edges[2 * n + 1] = merged.edges[n].high;
        }
    });
    parallel_for(threads, drawn.size(), [&](std::size_t chunk) { joiner.join(chunk); });
    for (const Drawn& chunk : drawn) mesh.intersected += chunk.intersected;
    drop_collapsed(mesh.triangles);
    return mesh;
}

template Mesh<float> march<float>(const Field<float>&, const Cells&, double, int, bool);
template Mesh<float> march<float>(const Field<double>&, const Cells&, double, int, bool);
template Mesh<double> march<double>(const Field<float>&, const Cells&, double, int, bool);
template Mesh<double> march<double>(const Field<double>&, const Cells&, double, int, bool);

}  // namespace isocore::marching_cells
