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

// The other face at the edge from point a to point b of a cell that was entered through a face at it.
inline std::size_t face_beyond(mesh::Tet, const std::int32_t* record, std::int32_t a, std::int32_t b,
                               std::size_t entered) {
    std::size_t beyond = 6 - entered;  // the corners' numbers add up to 6; a face has that of the corner it lacks
    for (std::size_t n = 0; n < 4; ++n) beyond -= record[n] == a || record[n] == b ? n : 0;
    return beyond;
}

inline std::size_t face_beyond(mesh::Hex, const std::int32_t* record, std::int32_t a, std::int32_t b,
                               std::size_t entered) {
    mesh::Mask both = 0;
    for (std::size_t n = 0; n < 8; ++n) both |= mesh::Mask{record[n] == a || record[n] == b} << n;
    for (std::size_t face = 0; face < 6; ++face) {
        if (face != entered && (mesh::Hex::kShape.face_corners[face] & both) == both) return face;
    }
    return entered;
}

// Walks around an edge of a cell from one of the two faces there, and calls visit(cell) for the cells it comes to until
// that returns true or the walk is back at the start. Returns where it left: kFaces * cell + face at the boundary, -1
// if it was stopped or went all the way round.
template <class Cell, class Visit>
std::int32_t walk_around(const std::int32_t* records, std::size_t start, std::size_t edge, std::size_t face,
                         const Visit& visit) {
    const std::int32_t* record = records + kRecord<Cell> * start;
    const std::int32_t a = record[Cell::kShape.ends[edge][0]], b = record[Cell::kShape.ends[edge][1]];
    for (std::size_t cell = start;;) {
        const std::int32_t twin = record[Cell::kCorners + face];
        if (twin < 0) return static_cast<std::int32_t>(Cell::kFaces * cell + face);
        cell = static_cast<std::size_t>(twin) / Cell::kFaces;
        if (cell == start || visit(cell)) return -1;
        record = records + kRecord<Cell> * cell;
        face = face_beyond(Cell{}, record, a, b, static_cast<std::size_t>(twin) % Cell::kFaces);
    }
}

}  // namespace isocore::thinning
