// gluing.cpp - Adjacency by a bucket sort of faces, then vertex and edge copies by walking around them. The guarantee
// is proved for the mesh glued along faces (docs/proofs/thinning.md, sections 1 and 2), which is why there are copies.
#include "thinning/mesh/gluing.hpp"

#include <algorithm>
#include <bit>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <utility>
#include <vector>

namespace isocore::thinning {
namespace {

using std::int32_t;
using std::size_t;

// A face by its points: the lowest is the bucket it is sorted into, the others tell it from the rest of the bucket.
struct Face {
    std::uint64_t next;  // triangle: the middle and the highest point; quadrilateral: the opposite and one neighbour
    std::uint32_t last;  // the other neighbour, or 0 of a triangle
    int32_t place;       // kFaces * cell + face
    bool same_points(const Face& other) const { return next == other.next && last == other.last; }
    bool operator<(const Face& other) const {
        if (next != other.next) return next < other.next;
        return last != other.last ? last < other.last : place < other.place;
    }
};

void order(int32_t& a, int32_t& b) {
    if (b < a) std::swap(a, b);
}

// The points of a face: the lowest, then for a triangle the others ascending, for a quadrilateral the opposite one and
// its two neighbours ascending.
std::array<int32_t, 3> named_points(mesh::Tet, const int32_t* ids, size_t face) {
    std::array<int32_t, 3> points;
    for (size_t n = 0; n < 3; ++n) points[n] = ids[n + (n >= face)];
    order(points[0], points[1]);
    order(points[1], points[2]);
    order(points[0], points[1]);
    return points;
}

std::array<int32_t, 4> named_points(mesh::Hex, const int32_t* ids, size_t face) {
    const auto ring = cube::face_ring(static_cast<int>(face));
    const auto point = [&](size_t n) { return ids[ring[n & 3]]; };
    size_t low = 0;
    for (size_t n = 1; n < 4; ++n) low = point(n) < point(low) ? n : low;
    std::array<int32_t, 4> points{point(low), point(low + 2), point(low + 1), point(low + 3)};
    order(points[2], points[3]);
    return points;
}

template <class Cell>
int32_t lowest_point(const int32_t* ids, size_t face) {
    int32_t low = std::numeric_limits<int32_t>::max();
    for (mesh::Mask left = Cell::kShape.face_corners[face]; left != 0; left &= left - 1)
        low = std::min(low, ids[std::countr_zero(left)]);
    return low;
}

template <class Cell>
bool collapsed(const int32_t* ids) {
    for (size_t a = 0; a < Cell::kCorners; ++a) {
        for (size_t b = a + 1; b < Cell::kCorners; ++b) {
            if (ids[a] == ids[b]) return true;
        }
    }
    return false;
}

// The faces of all cells but the collapsed ones, in buckets by their lowest point.
struct Buckets {
    Array<Face> faces;
    std::vector<std::uint32_t> end;  // of every point's bucket, which begins where the one before ends
};

template <class Cell>
Face named_face(const int32_t* corners, size_t cell, size_t face, int32_t& lowest) {
    const auto ids = named_points(Cell{}, corners, face);
    lowest = ids[0];
    const std::uint64_t next = static_cast<std::uint64_t>(ids[1]) << 32 | static_cast<std::uint32_t>(ids[2]);
    const std::uint32_t last = Cell::kFaceCorners == 4 ? static_cast<std::uint32_t>(ids[Cell::kFaceCorners - 1]) : 0;
    return {next, last, static_cast<int32_t>(Cell::kFaces * cell + face)};
}

// A counting sort: counts, prefix sums, scattering.
template <class Cell>
Buckets sort_faces(Gluing<Cell>& gluing, size_t points) {
    std::vector<std::uint32_t> start(points + 1);
    std::vector<std::uint8_t> loose(gluing.cells);
    for (size_t cell = 0; cell < gluing.cells; ++cell) {
        const int32_t* ids = gluing.corners.data() + Cell::kCorners * cell;
        if (collapsed<Cell>(ids)) {
            loose[cell] = 1;
            if (gluing.oddities.collapsed_cells++ == 0) gluing.oddities.collapsed_cell = static_cast<int32_t>(cell);
            continue;
        }
        for (size_t face = 0; face < Cell::kFaces; ++face)
            ++start[static_cast<size_t>(lowest_point<Cell>(ids, face)) + 1];
    }
    for (size_t point = 0; point < points; ++point) start[point + 1] += start[point];
    Array<Face> faces(start[points]);
    for (size_t cell = 0; cell < gluing.cells; ++cell) {
        if (loose[cell]) continue;
        for (size_t face = 0; face < Cell::kFaces; ++face) {
            int32_t lowest;
            const Face named = named_face<Cell>(gluing.corners.data() + Cell::kCorners * cell, cell, face, lowest);
            faces[start[static_cast<size_t>(lowest)]++] = named;
        }
    }
    return {std::move(faces), std::move(start)};  // scattering has moved every start to the bucket's end
}

// Makes twins of the two faces that are the same. Faces of more than two cells stay apart, and the first is reported.
template <class Cell>
void pair_faces(Gluing<Cell>& gluing, size_t points) {
    gluing.twins.resize(Cell::kFaces * gluing.cells);
    std::fill(gluing.twins.begin(), gluing.twins.end(), -1);
    Buckets buckets = sort_faces(gluing, points);
    Array<Face>& faces = buckets.faces;
    int32_t first_crowded = std::numeric_limits<int32_t>::max();
    size_t begin = 0;
    for (size_t point = 0; point < points; ++point) {
        const size_t end = buckets.end[point];
        std::sort(faces.begin() + static_cast<std::ptrdiff_t>(begin), faces.begin() + static_cast<std::ptrdiff_t>(end));
        for (size_t same = begin; begin < end; begin = same) {
            while (same < end && faces[same].same_points(faces[begin])) ++same;
            const int32_t a = faces[begin].place;
            if (same - begin == 2) {
                const int32_t b = faces[begin + 1].place;
                gluing.twins[static_cast<size_t>(a)] = b;
                gluing.twins[static_cast<size_t>(b)] = a;
            } else if (same - begin > 2) {
                ++gluing.oddities.crowded_faces;
                if (a >= first_crowded) continue;
                first_crowded = a;
                for (size_t n = 0; n < 3; ++n)
                    gluing.oddities.crowded_cells[n] = faces[begin + n].place / static_cast<int32_t>(Cell::kFaces);
            }
        }
    }
}

// The corner of a cell that is a point.
template <class Cell>
size_t corner_at(const int32_t* ids, int32_t point) {
    size_t corner = 0;
    while (ids[corner] != point) ++corner;
    return corner;
}

template <class Cell>
void name_vertex_copies(Gluing<Cell>& gluing, size_t points) {
    const size_t cells = gluing.cells;
    gluing.copies.resize(Cell::kCorners * cells);
    std::fill(gluing.copies.begin(), gluing.copies.end(), -1);
    std::vector<std::uint8_t> taken(points);
    size_t next = points;
    std::vector<std::pair<size_t, size_t>> open;  // cell, corner
    for (size_t start = 0; start < gluing.copies.size(); ++start) {
        if (gluing.copies[start] >= 0) continue;
        const int32_t point = gluing.corners[start];
        std::uint8_t& seen = taken[static_cast<size_t>(point)];
        const auto copy = static_cast<int32_t>(seen ? next++ : static_cast<size_t>(point));
        seen = 1;
        gluing.copies[start] = copy;
        open.emplace_back(start / Cell::kCorners, start % Cell::kCorners);
        while (!open.empty()) {
            const auto [cell, corner] = open.back();
            open.pop_back();
            for (size_t face = 0; face < Cell::kFaces; ++face) {
                if (!(Cell::kShape.face_corners[face] >> corner & 1)) continue;
                const int32_t across = gluing.neighbour(cell, face);
                if (across < 0) continue;
                const auto other = static_cast<size_t>(across);
                const size_t there = corner_at<Cell>(gluing.corners.data() + Cell::kCorners * other, point);
                int32_t& label = gluing.copies[Cell::kCorners * other + there];
                if (label >= 0) continue;
                label = copy;
                open.emplace_back(other, there);
            }
        }
    }
    if (next > static_cast<size_t>(std::numeric_limits<int32_t>::max()))
        throw std::length_error("the mesh has too many vertices");
    gluing.copy_count = next;
}

// The edge between two corners, and the two faces at every edge.
template <class Cell>
struct EdgeTables {
    std::array<std::array<std::uint8_t, Cell::kCorners>, Cell::kCorners> between{};
    std::array<std::array<std::uint8_t, 2>, Cell::kEdges> faces{};
};

template <class Cell>
constexpr EdgeTables<Cell> kEdgeTables = [] {
    EdgeTables<Cell> tables;
    for (std::uint8_t edge = 0; edge < Cell::kEdges; ++edge) {
        const auto& ends = Cell::kShape.ends[edge];
        tables.between[ends[0]][ends[1]] = tables.between[ends[1]][ends[0]] = edge;
        size_t filled = 0;
        for (std::uint8_t face = 0; face < Cell::kFaces; ++face) {
            if (Cell::kShape.face_edges[face] >> edge & 1) tables.faces[edge][filled++] = face;
        }
    }
    return tables;
}();

// Union-find over boundary faces: two that meet at an edge belong to one shell, a connected piece of boundary.
class Shells {
  public:
    explicit Shells(size_t faces) : parent_(faces) { std::iota(parent_.begin(), parent_.end(), 0); }
    int32_t find(int32_t face) {
        while (parent_[static_cast<size_t>(face)] != face) {
            face = parent_[static_cast<size_t>(face)] =
                parent_[static_cast<size_t>(parent_[static_cast<size_t>(face)])];
        }
        return face;
    }
    void unite(int32_t a, int32_t b) {
        a = find(a);
        b = find(b);
        parent_[static_cast<size_t>(std::max(a, b))] = std::min(a, b);
    }

  private:
    Array<int32_t> parent_;
};

// Walks around an edge, from a cell on through a face, and gives every edge of a cell that it passes the same name.
// Returns the boundary face where the walk ends, or -1 if it comes back to where it has been.
template <class Cell>
int32_t name_around(Gluing<Cell>& gluing, size_t cell, size_t edge, size_t face, int32_t name) {
    const auto& ends = Cell::kShape.ends[edge];
    const int32_t* ids = gluing.corners.data() + Cell::kCorners * cell;
    const int32_t a = ids[ends[0]], b = ids[ends[1]];
    for (;;) {
        const int32_t twin = gluing.twins[Cell::kFaces * cell + face];
        if (twin < 0) return -1 - twin;
        cell = static_cast<size_t>(twin) / Cell::kFaces;
        const size_t entered = static_cast<size_t>(twin) % Cell::kFaces;
        ids = gluing.corners.data() + Cell::kCorners * cell;
        const size_t here = kEdgeTables<Cell>.between[corner_at<Cell>(ids, a)][corner_at<Cell>(ids, b)];
        int32_t& label = gluing.edges[Cell::kEdges * cell + here];
        if (label >= 0) return -1;
        label = name;
        const auto& faces = kEdgeTables<Cell>.faces[here];
        face = faces[0] == entered ? faces[1] : faces[0];
    }
}

template <class Cell>
void name_edge_copies(Gluing<Cell>& gluing) {
    for (int32_t& twin : gluing.twins) {
        if (twin < 0) twin = -1 - static_cast<int32_t>(gluing.boundary_faces++);
    }
    Shells shells(gluing.boundary_faces);
    gluing.edges.resize(Cell::kEdges * gluing.cells);
    std::fill(gluing.edges.begin(), gluing.edges.end(), -1);
    size_t next = 0;
    for (size_t start = 0; start < gluing.edges.size(); ++start) {
        if (gluing.edges[start] >= 0) continue;
        const auto name = static_cast<int32_t>(next++);
        gluing.edges[start] = name;
        const size_t cell = start / Cell::kEdges, edge = start % Cell::kEdges;
        const auto& faces = kEdgeTables<Cell>.faces[edge];
        const int32_t one = name_around(gluing, cell, edge, faces[0], name);
        const int32_t other = name_around(gluing, cell, edge, faces[1], name);
        if (one >= 0 && other >= 0) shells.unite(one, other);
    }
    gluing.edge_count = next;
    gluing.shell.resize(gluing.boundary_faces);
    for (size_t face = 0; face < gluing.boundary_faces; ++face) {
        gluing.shell[face] = shells.find(static_cast<int32_t>(face));
        gluing.shells += gluing.shell[face] == static_cast<int32_t>(face);
    }
}

}  // namespace

template <class Cell>
Gluing<Cell> glue(Array<int32_t> corners, size_t points) {
    Gluing<Cell> gluing;
    gluing.cells = corners.size() / Cell::kCorners;
    gluing.corners = std::move(corners);
    if (gluing.cells * Cell::kEdges > static_cast<size_t>(std::numeric_limits<int32_t>::max())) {
        throw std::length_error("the mesh has more cells than an index can name");
    }
    pair_faces(gluing, points);
    name_vertex_copies(gluing, points);
    name_edge_copies(gluing);
    return gluing;
}

template Gluing<mesh::Tet> glue<mesh::Tet>(Array<int32_t>, size_t);
template Gluing<mesh::Hex> glue<mesh::Hex>(Array<int32_t>, size_t);

}  // namespace isocore::thinning
