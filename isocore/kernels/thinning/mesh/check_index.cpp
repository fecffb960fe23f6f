// check_index.cpp - An index may come from a file or from a caller's own arrays: what the walk relies on is checked
// here once, so that the walk itself need not check anything.
#include <algorithm>
#include <bit>
#include <cstdint>
#include <stdexcept>
#include <utility>
#include <vector>

#include "thinning/mesh/faces.hpp"
#include "thinning/mesh/thinning.hpp"

namespace isocore::thinning {
namespace {

using std::int32_t;
using std::size_t;

void require(bool holds, const char* what) {
    if (!holds) throw std::invalid_argument(what);
}

// Numbers below 0 are out of range too: as unsigned ones they are very large.
bool all_below(const int32_t* numbers, size_t count, size_t limit) {
    std::uint32_t highest = 0;
    for (size_t n = 0; n < count; ++n) highest = std::max(highest, static_cast<std::uint32_t>(numbers[n]));
    return count == 0 || highest < limit;
}

bool twins_exist(const int32_t* twins, size_t count, size_t all) {
    return std::all_of(twins, twins + count, [=](int32_t twin) { return twin < 0 || static_cast<size_t>(twin) < all; });
}

// The same for the same corners in any order, and hardly ever for others.
template <class Cell>
std::uint64_t hash_of_face(const int32_t* corners, size_t face) {
    std::uint64_t sum = 0;
    for (mesh::Mask left = Cell::kShape.face_corners[face]; left != 0; left &= left - 1) {
        const std::uint64_t mixed =
            (static_cast<std::uint64_t>(corners[std::countr_zero(left)]) + 1) * 0x9E3779B97F4A7C15u;
        sum += mixed ^ mixed >> 32;
    }
    return sum;
}

// Whether every face across which a cell is glued is the same face of the other cell, which is glued to this one.
template <class Cell>
bool glued_both_ways(const PartView& part, size_t cell) {
    const int32_t *corners = part.records + kRecord<Cell> * cell, *twins = corners + Cell::kCorners;
    for (size_t face = 0; face < Cell::kFaces; ++face) {
        if (twins[face] < 0) continue;
        const size_t other = static_cast<size_t>(twins[face]) / Cell::kFaces,
                     its_face = static_cast<size_t>(twins[face]) % Cell::kFaces;
        const int32_t* others = part.records + kRecord<Cell> * other;
        if (static_cast<size_t>(others[Cell::kCorners + its_face]) != Cell::kFaces * cell + face) return false;
        if (other > cell && hash_of_face<Cell>(corners, face) != hash_of_face<Cell>(others, its_face)) return false;
    }
    return true;
}

template <class Cell>
bool glued_nowhere(const int32_t* twins) {
    return std::all_of(twins, twins + Cell::kFaces, [](int32_t twin) { return twin < 0; });
}

template <class Cell>
void check_part(const PartView& part, size_t points) {
    int32_t lowest = 0;
    for (size_t cell = 0; cell < part.cells; ++cell) {
        const int32_t *corners = part.records + kRecord<Cell> * cell, *twins = corners + Cell::kCorners;
        require(all_below(corners, Cell::kCorners, points), "a record names a point that does not exist");
        require(twins_exist(twins, Cell::kFaces, Cell::kFaces * part.cells),
                "a record names a cell that does not exist");
        require(!is_collapsed<Cell>(corners) || glued_nowhere<Cell>(twins),
                "a record names a point twice and is glued all the same");
        const int32_t before = std::exchange(lowest, *std::min_element(corners, twins));
        require(before <= lowest, "the cells are not in the order of their lowest points");
    }
    for (size_t cell = 0; cell < part.cells; ++cell) {
        require(glued_both_ways<Cell>(part, cell), "a record is glued to a cell that is not glued to it");
    }
    require(all_below(part.skeleton, part.skeleton_size, part.cells), "the skeleton names a cell that does not exist");
    require(std::is_sorted(part.low, part.low + part.skeleton_size), "the skeleton is not sorted by its low ends");
}

}  // namespace

void check_index(const IndexView& index, size_t points) {
    check_part<mesh::Tet>(index.tets, points);
    check_part<mesh::Hex>(index.hexes, points);
}

}  // namespace isocore::thinning
