// cell_disks.hpp - What a cell of a label map draws: triangles between the labels of its eight corners, such that what
// it draws on a face depends on the four labels of that face alone. Corners, edges and faces as in common/cube.hpp.
//
// A place of the cell is where a vertex may lie: the middle of an edge (0..11), of a face (12..17), of the cell (18).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace isocore::labels {

constexpr std::uint8_t kFirstFace = 12, kMiddle = 18;

// Ranks of the labels of a cell's corners: background is lowest, then the others by their numbers.
using CornerRanks = std::array<std::uint32_t, 8>;

// A triangle of a cell: three places, counter-clockwise seen from the side of `ahead`. Both sides are named by a corner
// that has the label of that side.
struct CellTriangle {
    std::array<std::uint8_t, 3> places;
    std::uint8_t behind, ahead;
};

struct CellDisks {
    std::vector<CellTriangle> triangles;
    std::uint8_t faces = 0;      // faces whose middle is a vertex, a bit each: three labels and more meet there
    bool middle = false;         // is the cell's middle a vertex?
    bool several_cones = false;  // do several parts meet there? Then it must not move
};

// All that a cell's disks depend on: the partition of its corners by label (three bits a corner, labels numbered in the
// order in which corners first show them), and for each face with labels A B A B whether A, its first, ranks higher.
std::uint32_t disks_key(const CornerRanks& ranks);

// The disks of a cell, by its corners' ranks.
CellDisks derive_disks(const CornerRanks& ranks);

// Has a face with these labels, in ring order, a vertex in its middle? Where three labels and more meet, unless two
// opposite corners share a label.
template <class Rank>
constexpr bool meets_in_face(Rank a, Rank b, Rank c, Rank d) {
    const int crossings = (a != b) + (b != c) + (c != d) + (d != a);
    return crossings == 3 || (crossings == 4 && a != c && b != d);
}

}  // namespace isocore::labels
