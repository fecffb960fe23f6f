// mesh_normals.cpp - Gradients at the ends of crossed edges, gathered from all cells around them, also those that the
// isosurface misses: a mean over the whole neighbourhood is of second order where cells lie evenly, and that over the
// crossed cells alone, which triangles amount to, is not.
#include "surface/mesh_normals.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "common/crossing.hpp"
#include "common/mesh_cells.hpp"
#include "common/parallel.hpp"
#include "surface/normals.hpp"
#include "surface/unit.hpp"

namespace isocore {
namespace {

using mesh::CornerIds;
using mesh::Field;
using mesh::Hex;
using mesh::Tet;

constexpr std::size_t kChunk = 32768;
// Edges that nearly lie in the surface may run against the gradient by a little: the square of the cosine.
constexpr double kSlack = 0.04;

struct Mean {
    Vec3 sum{};
    double weight = 0;
};

// The points at the ends of crossed edges, numbered in ascending order; -1 for all others.
Array<std::int32_t> number_ends(const EdgesView& edges, std::size_t points, std::size_t& count) {
    Array<std::int32_t> number(points);
    std::fill(number.begin(), number.end(), -1);
    for (std::size_t n = 0; n < 2 * edges.count; ++n) {
        if (static_cast<std::size_t>(edges.ends[n]) >= points) throw std::invalid_argument("an edge names no point");
        number[static_cast<std::size_t>(edges.ends[n])] = 0;
    }
    count = 0;
    for (std::int32_t& own : number) {
        if (own == 0) own = static_cast<std::int32_t>(count++);
    }
    return number;
}

// The cells with a numbered corner, chunk by chunk.
template <class Cell>
std::vector<Array<std::uint32_t>> cells_around(const std::int32_t* cells, std::size_t count,
                                               const Array<std::int32_t>& number, int threads) {
    std::vector<Array<std::uint32_t>> found((count + kChunk - 1) / kChunk);
    parallel_for(threads, found.size(), [&](std::size_t chunk) {
        const std::size_t first = chunk * kChunk, end = std::min(count, first + kChunk);
        Array<std::uint32_t>& out = found[chunk];
        for (std::size_t cell = first; cell < end; ++cell) {
            const std::int32_t* corners = cells + Cell::kCorners * cell;
            bool near = false;
            for (std::size_t n = 0; n < Cell::kCorners; ++n) {
                if (static_cast<std::size_t>(corners[n]) >= number.size())
                    throw std::invalid_argument("a cell names no point");
                near |= number[static_cast<std::size_t>(corners[n])] >= 0;
            }
            if (near) out.push_back(static_cast<std::uint32_t>(cell));
        }
    });
    return found;
}

// The gradient of the linear function on a corner and its three neighbours, times the volume that they span.
template <class Value>
Mean gradient_at(const Field<Value>& field, std::int32_t corner, const std::array<std::int32_t, 3>& neighbours) {
    std::array<Vec3, 3> side;
    Vec3 rise;
    const double* origin = field.point(corner);
    for (std::size_t n = 0; n < 3; ++n) {
        const double* end = field.point(neighbours[n]);
        side[n] = {end[0] - origin[0], end[1] - origin[1], end[2] - origin[2]};
        rise[n] = static_cast<double>(field.value(neighbours[n])) - static_cast<double>(field.value(corner));
    }
    const std::array<Vec3, 3> faces{cross(side[1], side[2]), cross(side[2], side[0]), cross(side[0], side[1])};
    const double volume = dot(side[0], faces[0]), sign = volume < 0 ? -1 : 1;
    Mean mean{{}, std::abs(volume)};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        mean.sum[axis] = sign * (rise[0] * faces[0][axis] + rise[1] * faces[1][axis] + rise[2] * faces[2][axis]);
    }
    const double total = mean.sum[0] + mean.sum[1] + mean.sum[2];
    return std::isfinite(total) && std::isfinite(volume) ? mean : Mean{};
}

void add(const Mean& more, Mean& sum) {
    for (std::size_t axis = 0; axis < 3; ++axis) sum.sum[axis] += more.sum[axis];
    sum.weight += more.weight;
}

template <class Value>
void add_cell(Tet, const Field<Value>& field, const std::int32_t* corners, const std::array<std::int32_t, 4>& own,
              Mean* sums) {
    const Mean mean = gradient_at(field, corners[0], {corners[1], corners[2], corners[3]});
    for (const std::int32_t number : own) {
        if (number >= 0) add(mean, sums[number]);
    }
}

// A hexahedron's function is trilinear: at a corner its gradient is that along the three edges there.
template <class Value>
void add_cell(Hex, const Field<Value>& field, const std::int32_t* corners, const std::array<std::int32_t, 8>& own,
              Mean* sums) {
    for (std::size_t n = 0; n < 8; ++n) {
        const std::int32_t number = own[Hex::kFromVtk[n]];
        if (number < 0) continue;
        const auto id = [&](std::size_t corner) { return corners[Hex::kFromVtk[corner]]; };
        add(gradient_at(field, id(n), {id(n ^ 1), id(n ^ 2), id(n ^ 4)}), sums[number]);
    }
}

// Adds the gradients of some cells to those of the points numbered first .. end - 1.
template <class Cell, class Value>
void add_cells(const Field<Value>& field, const std::int32_t* cells, const std::vector<Array<std::uint32_t>>& around,
               const Array<std::int32_t>& number, std::size_t first, std::size_t end, Mean* sums) {
    for (const Array<std::uint32_t>& chunk : around) {
        for (const std::uint32_t cell : chunk) {
            const std::int32_t* corners = cells + Cell::kCorners * cell;
            std::array<std::int32_t, Cell::kCorners> own;
            bool any = false;
            for (std::size_t n = 0; n < Cell::kCorners; ++n) {
                const std::int32_t found = number[static_cast<std::size_t>(corners[n])];
                const bool is_own = found >= 0 && static_cast<std::size_t>(found) - first < end - first;
                own[n] = is_own ? found : -1;
                any |= is_own;
            }
            if (any) add_cell(Cell{}, field, corners, own, sums);
        }
    }
}

template <class Value>
std::vector<Mean> gradients(const Field<Value>& field, const CellsView& cells, const Array<std::int32_t>& number,
                            std::size_t count, int threads) {
    const auto tets = cells_around<Tet>(cells.tets, cells.tet_count, number, threads);
    const auto hexes = cells_around<Hex>(cells.hexes, cells.hex_count, number, threads);
    std::vector<Mean> sums(count);
    // Every thread goes over all of these cells, in their order, and looks after points of its own.
    const auto parts = static_cast<std::size_t>(std::max(threads, 1));
    parallel_for(threads, parts, [&](std::size_t part) {
        const std::size_t first = count * part / parts, end = count * (part + 1) / parts;
        add_cells<Tet>(field, cells.tets, tets, number, first, end, sums.data());
        add_cells<Hex>(field, cells.hexes, hexes, number, first, end, sums.data());
    });
    return sums;
}

// Down the gradient at a place on an edge. One that clearly contradicts the edge's own ends says nothing.
template <class Value>
bool store_normal(const Field<Value>& field, const std::int32_t* ends, double isovalue, const Mean& low,
                  const Mean& high, float* out) {
    const Value a = field.value(ends[0]), b = field.value(ends[1]);
    const double t = crossing(a, b, isovalue);
    const double to_low = low.weight > 0 ? (high.weight > 0 ? 1 - t : 1) / low.weight : 0;
    const double to_high = high.weight > 0 ? (low.weight > 0 ? t : 1) / high.weight : 0;
    Vec3 down, along;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        down[axis] = -(to_low * low.sum[axis] + to_high * high.sum[axis]);
        along[axis] = field.point(ends[1])[axis] - field.point(ends[0])[axis];
    }
    const bool rises = !std::isfinite(a) || (std::isfinite(b) && a < b);
    const double against = dot(down, along) * (rises ? 1 : -1);
    if (against > 0 && against * against > kSlack * dot(down, down) * dot(along, along)) return false;
    return store_unit(down, out);
}

}  // namespace

template <class Value, class Real>
Array<float> mesh_normals(const Field<Value>& field, const CellsView& cells, double isovalue, const EdgesView& edges,
                          const MeshView<Real>& surface, bool complete, int threads) {
    if (edges.count > surface.vertex_count) throw std::invalid_argument("there are more edges than vertices");
    std::size_t count = 0;
    const Array<std::int32_t> number = number_ends(edges, field.size, count);
    const std::vector<Mean> sums = gradients(field, cells, number, count, threads);
    return stored_normals(surface, complete, threads, [&](std::size_t v, float* out) {
        if (v >= edges.count) return false;
        const std::int32_t* ends = edges.ends + 2 * v;
        const auto sum = [&](std::int32_t point) -> const Mean& {
            return sums[static_cast<std::size_t>(number[static_cast<std::size_t>(point)])];
        };
        return store_normal(field, ends, isovalue, sum(ends[0]), sum(ends[1]), out);
    });
}

template Array<float> mesh_normals(const Field<float>&, const CellsView&, double, const EdgesView&,
                                   const MeshView<float>&, bool, int);
template Array<float> mesh_normals(const Field<float>&, const CellsView&, double, const EdgesView&,
                                   const MeshView<double>&, bool, int);
template Array<float> mesh_normals(const Field<double>&, const CellsView&, double, const EdgesView&,
                                   const MeshView<float>&, bool, int);
template Array<float> mesh_normals(const Field<double>&, const CellsView&, double, const EdgesView&,
                                   const MeshView<double>&, bool, int);

}  // namespace isocore
