// check_index.cpp - An index may come from a file or from a caller's own arrays: what the walk relies on is checked
// here once, so that the walk itself need not check anything.
#include <algorithm>
#include <stdexcept>
#include <vector>

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

// Marks the edges that a record owns (their ids are negated). False if an edge does not exist or is owned already.
bool take_owned(const int32_t* edges, size_t count, std::vector<bool>& owned) {
    for (size_t n = 0; n < count; ++n) {
        const auto edge = static_cast<size_t>(edges[n] < 0 ? ~edges[n] : edges[n]);
        if (edge >= owned.size()) return false;
        if (edges[n] >= 0) continue;
        if (owned[edge]) return false;
        owned[edge] = true;
    }
    return true;
}

template <class Cell>
void check_part(const PartView& part, size_t points, std::vector<bool>& owned) {
    for (size_t cell = 0; cell < part.cells; ++cell) {
        const int32_t *corners = part.records + kRecord<Cell> * cell, *twins = corners + Cell::kCorners,
                      *edges = twins + Cell::kFaces;
        require(all_below(corners, Cell::kCorners, points), "a record names a point that does not exist");
        require(twins_exist(twins, Cell::kFaces, Cell::kFaces * part.cells),
                "a record names a cell that does not exist");
        require(take_owned(edges, Cell::kEdges, owned), "a record names an edge that does not exist or has two owners");
    }
    require(all_below(part.skeleton, part.skeleton_size, part.cells), "the skeleton names a cell that does not exist");
    require(std::is_sorted(part.low, part.low + part.skeleton_size), "the skeleton is not sorted by its low ends");
}

}  // namespace

void check_index(const IndexView& index, size_t points, size_t edges) {
    std::vector<bool> owned(edges);
    check_part<mesh::Tet>(index.tets, points, owned);
    check_part<mesh::Hex>(index.hexes, points, owned);
    require(std::find(owned.begin(), owned.end(), false) == owned.end(), "an edge has no owner");
}

}  // namespace isocore::thinning
