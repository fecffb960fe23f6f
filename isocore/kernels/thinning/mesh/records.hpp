// records.hpp - What an index keeps of every cell: its corners' points, and its twins, which are the same faces seen
// from the other side. A tetrahedron's record is half a line of the cache.
#pragma once

#include <cstddef>
#include <cstdint>

#include "common/mesh_cells.hpp"

namespace isocore::thinning {

// kCorners points, upright, in our order; then kFaces twins: kFaces * cell + face, or below 0 where no cell lies.
template <class Cell>
inline constexpr std::size_t kRecord = Cell::kCorners + Cell::kFaces;

// The cell across a face, or -1.
template <class Cell>
std::int32_t neighbour(const std::int32_t* record, std::size_t face) {
    const std::int32_t twin = record[Cell::kCorners + face];
    return twin < 0 ? -1 : twin / static_cast<std::int32_t>(Cell::kFaces);
}

// The edges and corners of every set of faces.
struct Closure {
    std::uint16_t edges = 0;
    std::uint8_t corners = 0;
};

template <class Cell>
inline constexpr auto kClosure = [] {
    std::array<Closure, std::size_t{1} << Cell::kFaces> closures{};
    for (std::size_t faces = 0; faces < closures.size(); ++faces) {
        for (std::size_t face = 0; face < Cell::kFaces; ++face) {
            if (!(faces >> face & 1)) continue;
            closures[faces].edges = static_cast<std::uint16_t>(closures[faces].edges | Cell::kShape.face_edges[face]);
            closures[faces].corners =
                static_cast<std::uint8_t>(closures[faces].corners | Cell::kShape.face_corners[face]);
        }
    }
    return closures;
}();

// The faces at an edge of a cell.
template <class Cell>
inline constexpr auto kFacesAtEdge = [] {
    std::array<std::array<std::uint8_t, 2>, Cell::kEdges> faces{};
    for (std::size_t edge = 0; edge < Cell::kEdges; ++edge) {
        std::size_t filled = 0;
        for (std::uint8_t face = 0; face < Cell::kFaces; ++face) {
            if (Cell::kShape.face_edges[face] >> edge & 1) faces[edge][filled++] = face;
        }
    }
    return faces;
}();

// Which face comes next on the way around an edge. In a tetrahedron that was entered, it is opposite to the corner that
// the face behind has beside the edge, and the corner opposite to the face behind is the one of the next such face.
template <class Cell>
class Turning {
  public:
    Turning(const std::int32_t* record, std::size_t edge, std::size_t face)
        : beside_(record[kFacesAtEdge<Cell>[edge][kFacesAtEdge<Cell>[edge][0] == face]]) {
        static_assert(Cell::kCorners == 4);
    }
    std::size_t face_beyond(const std::int32_t* record, std::size_t entered) {
        std::size_t beyond = 0;
        for (std::size_t n = 1; n < 4; ++n) beyond += n * (record[n] == beside_);
        beside_ = record[entered];
        return beyond;
    }

  private:
    std::int32_t beside_;
};

template <>
class Turning<mesh::Hex> {
  public:
    Turning(const std::int32_t* record, std::size_t edge, std::size_t)
        : a_(record[mesh::Hex::kShape.ends[edge][0]]), b_(record[mesh::Hex::kShape.ends[edge][1]]) {}
    std::size_t face_beyond(const std::int32_t* record, std::size_t entered) const {
        mesh::Mask both = 0;
        for (std::size_t n = 0; n < 8; ++n) both |= mesh::Mask{record[n] == a_ || record[n] == b_} << n;
        for (std::size_t face = 0; face < 6; ++face) {
            if (face != entered && (mesh::Hex::kShape.face_corners[face] & both) == both) return face;
        }
        return entered;
    }

  private:
    std::int32_t a_, b_;
};

// A walk around an edge of a cell, by way of one of the two faces there, cell by cell.
template <class Cell>
class EdgeWalk {
  public:
    EdgeWalk(const std::int32_t* records, std::size_t start, std::size_t edge, std::size_t face)
        : records_(records), cell_(start), face_(face), turning_(records + kRecord<Cell> * start, edge, face) {}

    std::size_t cell() const { return cell_; }
    std::size_t face() const { return face_; }  // which the walk would go on through

    // Goes on to the next cell; false at the boundary.
    bool step() {
        const std::int32_t twin = records_[kRecord<Cell> * cell_ + Cell::kCorners + face_];
        if (twin < 0) return false;
        cell_ = static_cast<std::size_t>(twin) / Cell::kFaces;
        face_ = turning_.face_beyond(records_ + kRecord<Cell> * cell_, static_cast<std::size_t>(twin) % Cell::kFaces);
        return true;
    }

  private:
    const std::int32_t* records_;
    std::size_t cell_, face_;
    Turning<Cell> turning_;
};

// Walks around an edge of a cell from one of the two faces there, and calls visit(cell) for the cells it comes to until
// that returns true or the walk is back at the start. Returns where it left: kFaces * cell + face at the boundary, -1
// if it was stopped or went all the way round.
template <class Cell, class Visit>
std::int32_t walk_around(const std::int32_t* records, std::size_t start, std::size_t edge, std::size_t face,
                         const Visit& visit) {
    EdgeWalk<Cell> walk(records, start, edge, face);
    while (walk.step()) {
        if (walk.cell() == start || visit(walk.cell())) return -1;
    }
    return static_cast<std::int32_t>(Cell::kFaces * walk.cell() + walk.face());
}

}  // namespace isocore::thinning
