// propagate.cpp - Isosurface propagation: from the skeleton cells that hold the isovalue, breadth first through the faces that
// the isosurface crosses. On signs only, never on geometry: a face is crossed iff its corners differ in sign, and then
// both of its cells are. Numbering vertices needs no hash, since every cell knows the numbers of its edges.
#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "common/mesh_cases.hpp"
#include "common/parallel.hpp"
#include "thinning/range_lookup.hpp"
#include "thinning/thinning.hpp"

#if defined(__GNUC__) || defined(__clang__)
#define ISOCORE_PREFETCH(address) __builtin_prefetch(address)
#else
#define ISOCORE_PREFETCH(address) static_cast<void>(address)
#endif

namespace isocore::thinning {
namespace {

using mesh::Field;
using mesh::Hex;
using mesh::Mask;
using mesh::Tet;
using std::int32_t;
using std::size_t;

constexpr size_t kChunk = 4096, kAhead = 8;

struct Vertex {
    int32_t a, b;  // the points its edge joins
    int32_t edge;
};

struct Walked {
    Array<int32_t> cells;         // in the order visited
    Array<std::uint8_t> signs;    // of their corners, which are inside
};

template <class Cell, class Value>
class Walk {
  public:
    // Numbers the vertices it comes upon, unless vertex_of_edge is null.
    Walk(const Field<Value>& field, const PartView& part, int32_t* vertex_of_edge, double isovalue, Array<Vertex>& vertices)
        : field_(field), part_(part), vertex_of_edge_(vertex_of_edge), inside_(isovalue, false), vertices_(vertices) {}

    // Visits every cell that can be reached from the seeds.
    void run(double isovalue) {
        RangeLookup(part_.low, part_.high, part_.skeleton_size).find(isovalue, [&](size_t n) {
            ++seeds;
            visit(part_.skeleton[n]);
        });
        for (size_t head = 0; head < walked.cells.size(); ++head) {
            if (head + kAhead < walked.cells.size()) {
                const int32_t* later = record(walked.cells[head + kAhead]);
                ISOCORE_PREFETCH(later);
                ISOCORE_PREFETCH(later + kRecord<Cell> - 1);
            }
            step(record(walked.cells[head]));
        }
    }

    void forget() {
        for (const int32_t cell : walked.cells) part_.visited[cell] = 0;
    }

    const int32_t* record(int32_t cell) const { return part_.records + kRecord<Cell> * static_cast<size_t>(cell); }

    Walked walked;
    size_t seeds = 0;

  private:
    void visit(int32_t cell) {
        std::uint8_t& visited = part_.visited[cell];
        if (visited) return;
        visited = 1;
        walked.cells.push_back(cell);
    }

    void step(const int32_t* corners) {
        const int32_t* twins = corners + Cell::kCorners;
        const int32_t* edges = twins + Cell::kFaces;
        Mask signs = 0;
        for (size_t n = 0; n < Cell::kCorners; ++n) signs |= Mask{inside_(field_.value(corners[n]))} << n;
        walked.signs.push_back(static_cast<std::uint8_t>(signs));
        for (Mask left = mesh::kCrossedFaces<Cell>[signs]; left != 0; left &= left - 1) {
            const int32_t twin = twins[std::countr_zero(left)];
            if (twin >= 0) visit(twin / static_cast<int32_t>(Cell::kFaces));
        }
        if (vertex_of_edge_ == nullptr) return;
        for (Mask left = mesh::kCrossedEdges<Cell>[signs]; left != 0; left &= left - 1) {
            const auto n = static_cast<size_t>(std::countr_zero(left));
            int32_t& vertex = vertex_of_edge_[edges[n]];
            if (vertex >= 0) continue;
            vertex = static_cast<int32_t>(vertices_.size());
            vertices_.push_back({corners[Cell::kShape.ends[n][0]], corners[Cell::kShape.ends[n][1]], edges[n]});
        }
    }

    const Field<Value>& field_;
    const PartView& part_;
    int32_t* vertex_of_edge_;
    Inside<Value> inside_;
    Array<Vertex>& vertices_;
};

// Draws what a walk has visited, chunk by chunk. Two passes, since hexahedra do not tell from their signs alone how many
// triangles they draw.
template <class Cell, class Value>
class Drawing {
  public:
    Drawing(const Walk<Cell, Value>& walk, const Field<Value>& field, const int32_t* vertex_of_edge, double isovalue)
        : walk_(walk), field_(field), vertex_of_edge_(vertex_of_edge), isovalue_(isovalue), chunks_((walk.walked.cells.size() + kChunk - 1) / kChunk) {}

    size_t chunks() const { return chunks_.size(); }

    void count(size_t chunk) {
        for_each(chunk, [&](const int32_t*, const auto& drawn) {
            chunks_[chunk].triangles += drawn.triangles;
            chunks_[chunk].middles += drawn.middles;
        });
    }

    // Moves the chunks behind what others draw.
    void place(size_t& triangles, size_t& middles) {
        for (Chunk& chunk : chunks_) {
            triangles += std::exchange(chunk.triangles, triangles);
            middles += std::exchange(chunk.middles, middles);
        }
    }

    void draw(size_t chunk, Mesh& mesh) const {
        int32_t* out = mesh.triangles.data() + 3 * chunks_[chunk].triangles;
        size_t middle = chunks_[chunk].middles;
        for_each(chunk, [&](const int32_t* corners, const auto& drawn) {
            const int32_t* edges = corners + Cell::kCorners + Cell::kFaces;
            for (size_t n = 0; n < 3u * drawn.triangles; ++n) {
                const size_t edge = drawn.edges[n];
                *out++ = edge < mesh::kMiddle ? vertex_of_edge_[edges[edge]] : static_cast<int32_t>(middle + edge - mesh::kMiddle);
            }
            const auto position = [&](size_t edge) { return mesh.vertices.data() + 3 * static_cast<size_t>(vertex_of_edge_[edges[edge]]); };
            mesh::write_middles(drawn, position, mesh.vertices.data() + 3 * middle);
            middle += drawn.middles;
        });
    }

  private:
    struct Chunk {
        size_t triangles = 0, middles = 0;
    };

    template <class Visit>
    void for_each(size_t chunk, const Visit& visit) const {
        const size_t end = std::min(walk_.walked.cells.size(), (chunk + 1) * kChunk);
        for (size_t n = chunk * kChunk; n < end; ++n) {
            const int32_t* corners = walk_.record(walk_.walked.cells[n]);
            visit(corners, mesh::drawn(Cell{}, walk_.walked.signs[n], [&](size_t corner) { return static_cast<double>(field_.value(corners[corner])); }, isovalue_));
        }
    }

    const Walk<Cell, Value>& walk_;
    const Field<Value>& field_;
    const int32_t* vertex_of_edge_;
    double isovalue_;
    std::vector<Chunk> chunks_;
};

// Cells that name a point twice draw triangles with two equal corners.
void drop_collapsed(Array<int32_t>& triangles) {
    size_t end = 0;
    for (size_t n = 0; n < triangles.size(); n += 3) {
        const int32_t a = triangles[n], b = triangles[n + 1], c = triangles[n + 2];
        if (a == b || b == c || c == a) continue;
        triangles[end] = a;
        triangles[end + 1] = b;
        triangles[end + 2] = c;
        end += 3;
    }
    triangles.resize(end);
}

}  // namespace

template <class Value>
Mesh propagate(const Field<Value>& field, const IndexView& index, double isovalue, int threads) {
    Array<Vertex> crossed;
    Walk<Tet, Value> tets(field, index.tets, index.vertex_of_edge, isovalue, crossed);
    Walk<Hex, Value> hexes(field, index.hexes, index.vertex_of_edge, isovalue, crossed);
    tets.run(isovalue);
    hexes.run(isovalue);
    Drawing<Tet, Value> drawn_tets(tets, field, index.vertex_of_edge, isovalue);
    Drawing<Hex, Value> drawn_hexes(hexes, field, index.vertex_of_edge, isovalue);
    for (size_t chunk = 0; chunk < drawn_tets.chunks(); ++chunk) drawn_tets.count(chunk);
    parallel_for(threads, drawn_hexes.chunks(), [&](size_t chunk) { drawn_hexes.count(chunk); });
    size_t triangles = 0, vertices = crossed.size();
    drawn_tets.place(triangles, vertices);
    drawn_hexes.place(triangles, vertices);
    if (vertices > static_cast<size_t>(std::numeric_limits<int32_t>::max())) {
        throw std::length_error("the surface has more vertices than 2^31 - 1; choose another isovalue");
    }
    Mesh mesh;
    mesh.vertices.resize(3 * vertices);
    mesh.triangles.resize(3 * triangles);
    const auto place_vertices = [&](size_t chunk) {
        const size_t end = std::min(crossed.size(), (chunk + 1) * kChunk);
        for (size_t n = chunk * kChunk; n < end; ++n) {
            const auto [a, b, edge] = crossed[n];
            const bool ascending = index.points[a] < index.points[b];
            field.cross(ascending ? a : b, ascending ? b : a, isovalue, mesh.vertices.data() + 3 * n);
        }
    };
    // Starting threads costs as much as a chunk: one round for all but the hexahedra, whose middles need the vertices.
    const size_t vertex_chunks = (crossed.size() + kChunk - 1) / kChunk;
    parallel_for(threads, vertex_chunks + drawn_tets.chunks(), [&](size_t task) {
        task < vertex_chunks ? place_vertices(task) : drawn_tets.draw(task - vertex_chunks, mesh);
    });
    parallel_for(threads, drawn_hexes.chunks(), [&](size_t chunk) { drawn_hexes.draw(chunk, mesh); });
    drop_collapsed(mesh.triangles);
    for (const Vertex& vertex : crossed) index.vertex_of_edge[vertex.edge] = -1;
    tets.forget();
    hexes.forget();
    mesh.seeds = tets.seeds + hexes.seeds;
    mesh.visited = tets.walked.cells.size() + hexes.walked.cells.size();
    return mesh;
}

template <class Value>
Visited walk(const Field<Value>& field, const IndexView& index, double isovalue) {
    Array<Vertex> none;
    Walk<Tet, Value> tets(field, index.tets, nullptr, isovalue, none);
    Walk<Hex, Value> hexes(field, index.hexes, nullptr, isovalue, none);
    tets.run(isovalue);
    hexes.run(isovalue);
    tets.forget();
    hexes.forget();
    return {std::move(tets.walked.cells), std::move(hexes.walked.cells), tets.seeds + hexes.seeds};
}

template Visited walk<float>(const Field<float>&, const IndexView&, double);
template Visited walk<double>(const Field<double>&, const IndexView&, double);
template Mesh propagate<float>(const Field<float>&, const IndexView&, double, int);
template Mesh propagate<double>(const Field<double>&, const IndexView&, double, int);

}  // namespace isocore::thinning
