// cells.hpp - The cells that everything here is found by: cubes of equal side, for volumes those of the sample grid.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "simplification/types.hpp"

namespace isocore::simplification {

using Cell = std::array<std::int32_t, 3>;

inline constexpr int kBoxBits = 5;
inline constexpr std::int32_t kBoxCells = 1 << kBoxBits;  // along each axis of a box, the unit of parallel work

// Of a cell among so many along each axis: row by row, layer by layer.
inline std::size_t number_of(const Cell& cell, const std::array<std::size_t, 3>& dims) {
    return static_cast<std::size_t>(cell[0]) +
           dims[0] * (static_cast<std::size_t>(cell[1]) + dims[1] * static_cast<std::size_t>(cell[2]));
}

// visit(cell) of each from `low` to `high`, both included: row by row, layer by layer.
template <class Visit>
void each_cell_between(const Cell& low, const Cell& high, const Visit& visit) {
    for (std::int32_t k = low[2]; k <= high[2]; ++k) {
        for (std::int32_t j = low[1]; j <= high[1]; ++j) {
            for (std::int32_t i = low[0]; i <= high[0]; ++i) visit(Cell{i, j, k});
        }
    }
}

struct Cells {
    std::array<double, 3> origin{0, 0, 0};  // the low corner of cell 0, 0, 0
    double per_cell = 1;                    // from coordinates to cells
    std::array<std::size_t, 3> dims{1, 1, 1};
    // In coordinates. A vertex that is nearer to a wall between two boxes does not move, nor do its neighbours.
    double margin = 0;

    // Cells that hold all vertices of a mesh, not many more than it has triangles: where there were, they are twice as
    // wide, or four times and so on. Where the side is 1, corners of cells have whole coordinates.
    template <class Real>
    static Cells around(const MeshArrays<Real>& mesh, double side) {
        std::array<double, 3> low, high;
        low.fill(std::numeric_limits<double>::infinity());
        high.fill(-std::numeric_limits<double>::infinity());
        for (std::size_t n = 0; n < 3 * mesh.vertex_count; ++n) {
            const double at = static_cast<double>(mesh.vertices[n]);
            low[n % 3] = std::min(low[n % 3], at);
            high[n % 3] = std::max(high[n % 3], at);
        }
        constexpr double kMostPerTriangle = 32, kMostPerAxis = 1 << 20;
        const double most = 4096 + kMostPerTriangle * static_cast<double>(mesh.triangle_count);
        Cells out;
        for (; mesh.vertex_count > 0; side *= 2) {
            std::array<double, 3> dims;
            for (std::size_t a = 0; a < 3; ++a) {
                out.origin[a] = std::floor(low[a] / side) * side;
                dims[a] = std::floor((high[a] - out.origin[a]) / side) + 1;
            }
            if (dims[0] * dims[1] * dims[2] > most || *std::max_element(dims.begin(), dims.end()) > kMostPerAxis)
                continue;
            for (std::size_t a = 0; a < 3; ++a) out.dims[a] = static_cast<std::size_t>(dims[a]);
            break;
        }
        out.per_cell = 1 / side;
        return out;
    }

    double in_cells(double coordinate, std::size_t axis) const { return (coordinate - origin[axis]) * per_cell; }

    // The cell of a place, clamped to those that there are.
    // step: how far the place is moved along each axis.
    template <class Real>
    Cell at(const Real* place, double step = 0) const {
        Cell out;
        for (std::size_t a = 0; a < 3; ++a) out[a] = clamped(in_cells(static_cast<double>(place[a]) + step, a), a);
        return out;
    }
    // That for which a vertex counts where boxes are made of cells. Where there is a margin, boxes begin and end a
    // little before their cells do: with many vertices on whole coordinates, all of those would be too near to walls.
    template <class Real>
    Cell home(const Real* place, double step = 0) const {
        return at(place, 2 * margin + step);
    }
    // The first cell in which places may lie that have their home in the cells from `low` on.
    Cell first_of_home(Cell low) const {
        for (std::int32_t& at : low) at = margin > 0 ? std::max(at - 1, 0) : at;
        return low;
    }
    std::int32_t clamped(double in_cells, std::size_t axis) const {
        const double most = static_cast<double>(dims[axis] - 1);
        return static_cast<std::int32_t>(std::clamp(in_cells, 0.0, most));
    }
    std::size_t number(const Cell& cell) const { return number_of(cell, dims); }
};

}  // namespace isocore::simplification
