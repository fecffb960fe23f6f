// lots.hpp - Visited cells in lots: ranges of lowest points with some 2,048 cells each.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "thinning/mesh/walk.hpp"

namespace isocore::thinning {

// Where a lot begins: its first point, and its first visited cells.
struct Lot {
    std::int32_t point;
    std::size_t tet, hex;
};

template <class Cell, class Value>
std::int32_t lowest_point(const Walk<Cell, Value>& walk, std::size_t n) {
    const std::int32_t* corners = walk.record(walk.cells()[n]);
    return *std::min_element(corners, corners + Cell::kCorners);
}

// The first visited cell whose lowest point is not before a point.
template <class Cell, class Value>
std::size_t first_cell(const Walk<Cell, Value>& walk, std::int32_t point) {
    std::size_t first = 0, end = walk.size();
    while (first < end) {
        const std::size_t middle = (first + end) / 2;
        if (lowest_point(walk, middle) < point)
            first = middle + 1;
        else
            end = middle;
    }
    return first;
}

// All lots, at least one, and after them where the last one ends. Cells with the same lowest point stay together,
// however many they are.
template <class Value>
std::vector<Lot> cut_into_lots(const Walk<mesh::Tet, Value>& tets, const Walk<mesh::Hex, Value>& hexes) {
    constexpr std::size_t kLot = 2048;
    std::vector<std::int32_t> points{0};
    for (std::size_t n = kLot; n < tets.size(); n += kLot) points.push_back(lowest_point(tets, n));
    for (std::size_t n = kLot; n < hexes.size(); n += kLot) points.push_back(lowest_point(hexes, n));
    std::sort(points.begin(), points.end());
    points.erase(std::unique(points.begin(), points.end()), points.end());
    std::vector<Lot> lots;
    for (const std::int32_t point : points) lots.push_back({point, first_cell(tets, point), first_cell(hexes, point)});
    lots.push_back({std::numeric_limits<std::int32_t>::max(), tets.size(), hexes.size()});
    return lots;
}

}  // namespace isocore::thinning
