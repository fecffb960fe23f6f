// mesh_field.hpp - A view of a mesh with one value per point, and what is computed from it cell by cell: orientation,
// crossing points. Edges run from the lower point id to the higher, so that all cells around one agree to the last bit.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "common/crossing.hpp"
#include "common/mesh_cells.hpp"

namespace isocore::mesh {

template <class Value>
struct Field {
    const double* points;  // x, y, z of every point
    const Value* values;
    std::size_t size;

    const double* point(std::int32_t id) const { return points + 3 * static_cast<std::size_t>(id); }
    Value value(std::int32_t id) const { return values[static_cast<std::size_t>(id)]; }
    // A value as the inside rule orders it: whatever is not finite lies below every isovalue.
    double height(std::int32_t id) const {
        const Value value_there = value(id);
        return std::isfinite(value_there) ? static_cast<double>(value_there) : -std::numeric_limits<double>::infinity();
    }

    // Writes where the isosurface crosses the edge from point a to point b, which has the higher id in the mesh.
    template <class Coordinate>
    void cross(std::int32_t a, std::int32_t b, double isovalue, Coordinate* out) const {
        const double t = crossing(value(a), value(b), isovalue);
        const double *from = point(a), *to = point(b);
        for (int axis = 0; axis < 3; ++axis)
            out[axis] = static_cast<Coordinate>(from[axis] + t * (to[axis] - from[axis]));
    }
};

namespace detail {

using Vector = std::array<double, 3>;

inline double triple(const Vector& a, const Vector& b, const Vector& c) {
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

}  // namespace detail

// Is a cell (corners in our order) inside out? A cell without volume is not.
template <class Value>
bool inside_out(Tet, const Field<Value>& field, const CornerIds<Tet>& ids) {
    std::array<detail::Vector, 3> side;
    const double* origin = field.point(ids[0]);
    for (std::size_t n = 0; n < 3; ++n) {
        for (std::size_t axis = 0; axis < 3; ++axis) side[n][axis] = field.point(ids[n + 1])[axis] - origin[axis];
    }
    return detail::triple(side[0], side[1], side[2]) < 0;
}

// For a hexahedron the three directions are those from face to opposite face.
template <class Value>
bool inside_out(Hex, const Field<Value>& field, const CornerIds<Hex>& ids) {
    std::array<detail::Vector, 3> across{};
    for (std::size_t corner = 0; corner < 8; ++corner) {
        for (std::size_t n = 0; n < 3; ++n) {
            const double sign = corner >> n & 1 ? 1.0 : -1.0;
            for (std::size_t axis = 0; axis < 3; ++axis) across[n][axis] += sign * field.point(ids[corner])[axis];
        }
    }
    return detail::triple(across[0], across[1], across[2]) < 0;
}

// A cell as the mesh gives it (VTK's corner order), in our order and turned right side out.
template <class Cell, class Value>
CornerIds<Cell> upright(const Field<Value>& field, const std::int32_t* vtk_corners) {
    CornerIds<Cell> ids, turned;
    for (std::size_t n = 0; n < Cell::kCorners; ++n) ids[n] = vtk_corners[Cell::kFromVtk[n]];
    if (!inside_out(Cell{}, field, ids)) return ids;
    for (std::size_t n = 0; n < Cell::kCorners; ++n) turned[n] = ids[Cell::kMirrored[n]];
    return turned;
}

}  // namespace isocore::mesh
