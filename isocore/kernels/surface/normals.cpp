// normals.cpp - Vertex normals from the samples' gradient or from the triangles.
#include "surface/normals.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>
#include <vector>

#include "samples/sample_types.hpp"
#include "surface/unit.hpp"

namespace isocore {
namespace {

// A corner that weighs less than this is left out, which spares its seven samples. Both ends of a crossed edge weigh at
// least four times as much (kClamp in crossing.hpp).
constexpr double kWeightless = 1.0 / 4096;
// Edges that nearly lie in the surface may run against the gradient by a little: the square of the cosine.
constexpr double kSlack = 0.04;

template <class Sample>
bool is_finite(Sample value) {
    if constexpr (std::is_floating_point_v<Sample>) return std::isfinite(value);
    return true;
}

struct Mean {
    double sum = 0;
    double weight = 0;
    void add(double value, double its_weight) {
        sum += value * its_weight;
        weight += its_weight;
    }
    double value() const { return weight > 0 ? sum / weight : 0; }
};

// Adds the derivative along one axis at a grid point, per index step, unless neither neighbour helps.
template <class Sample>
void add_difference(const GridView<const Sample>& samples, const Dims& at, int axis, double weight, Mean& mean) {
    const auto a = static_cast<std::size_t>(axis);
    const Sample* here = samples.data + samples.index(at[0], at[1], at[2]);
    const std::size_t step = samples.step(axis);
    const bool has_low = at[a] > 0 && is_finite(*(here - step));
    const bool has_high = at[a] + 1 < samples.dims[a] && is_finite(here[step]);
    const double value = static_cast<double>(*here);
    const double low = has_low ? static_cast<double>(*(here - step)) : value;
    const double high = has_high ? static_cast<double>(here[step]) : value;
    if (has_low || has_high) mean.add((high - low) / (has_low && has_high ? 2 : 1), weight);
}

struct Cell {
    Dims corner;
    Vec3 fraction;
};

// The cell around a place inside the grid, and how far inside that cell the place is.
Cell cell_around(const Dims& dims, const Vec3& place) {
    Cell cell{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        cell.corner[axis] = std::min(static_cast<std::size_t>(place[axis]), dims[axis] - 2);
        const double fraction = place[axis] - static_cast<double>(cell.corner[axis]);
        cell.fraction[axis] = fraction < kWeightless ? 0 : fraction > 1 - kWeightless ? 1 : fraction;
    }
    return cell;
}

bool is_on_grid(const Dims& dims, const Vec3& place) {
    bool on_grid = true;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        on_grid = on_grid && place[axis] >= 0 && place[axis] <= static_cast<double>(dims[axis] - 1);
    }
    return on_grid;
}

// A grid edge that a place lies on: the sample at its lower end, its axis, and how far along it the place is.
struct GridEdge {
    Dims low;
    std::size_t axis = 3;
    double fraction = 0;
};

// The edge of a place, if there is exactly one; else axis is 3.
GridEdge edge_around(const Cell& cell) {
    GridEdge edge{cell.corner};
    std::size_t fractions = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double fraction = cell.fraction[axis];
        edge.low[axis] += fraction == 1;
        if (fraction == 0 || fraction == 1) continue;
        ++fractions;
        edge.axis = axis;
        edge.fraction = fraction;
    }
    if (fractions != 1) edge.axis = 3;
    return edge;
}

// The gradient on an edge away from the border, where all samples around are finite: false if they are not.
template <class Sample>
bool inner_gradient(const GridView<const Sample>& samples, const GridEdge& edge, Vec3& rise) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (edge.low[axis] < 1 || edge.low[axis] + 3 > samples.dims[axis]) return false;
    }
    const Sample* low = samples.data + samples.index(edge.low[0], edge.low[1], edge.low[2]);
    const Sample* high = low + samples.step(static_cast<int>(edge.axis));
    const auto at = [](const Sample* place) { return static_cast<double>(*place); };
    const double to_high = edge.fraction / 2, to_low = 0.5 - to_high;
    double all = at(low) + at(high);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t step = samples.step(static_cast<int>(axis));
        rise[axis] = to_low * (at(low + step) - at(low - step)) + to_high * (at(high + step) - at(high - step));
        all += rise[axis];
    }
    return std::is_integral_v<Sample> || std::isfinite(all);
}

template <class Sample>
Vec3 gradient(const GridView<const Sample>& samples, const Cell& cell) {
    std::array<Mean, 3> along;
    for (std::size_t corner = 0; corner < 8; ++corner) {
        double weight = 1;
        Dims at = cell.corner;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const bool upper = (corner >> axis & 1) != 0;
            at[axis] += upper;
            weight *= upper ? cell.fraction[axis] : 1 - cell.fraction[axis];
        }
        if (weight == 0 || !is_finite(samples.at(at[0], at[1], at[2]))) continue;
        for (int axis = 0; axis < 3; ++axis) {
            add_difference(samples, at, axis, weight, along[static_cast<std::size_t>(axis)]);
        }
    }
    return {along[0].value(), along[1].value(), along[2].value()};
}

// Does the gradient on an edge clearly run against the edge's own two samples, as noise can make it?
template <class Sample>
bool contradicts(const GridView<const Sample>& samples, const GridEdge& edge, const Vec3& rise) {
    const Sample* ends = samples.data + samples.index(edge.low[0], edge.low[1], edge.low[2]);
    const Sample upper = ends[samples.step(static_cast<int>(edge.axis))];
    if (!is_finite(*ends) || !is_finite(upper)) return false;
    const double along = rise[edge.axis];
    return along * (static_cast<double>(upper) - static_cast<double>(*ends)) < 0 &&
           along * along > kSlack * dot(rise, rise);
}

}  // namespace

template <class Sample, class Real>
Array<float> gradient_normals(GridView<const Sample> samples, const MeshView<Real>& mesh, bool below, bool complete,
                              int threads) {
    check_indices(mesh.triangles, mesh.triangle_count, mesh.vertex_count);
    const double sign = below ? 1 : -1;
    return stored_normals(mesh, complete, threads, [&](std::size_t v, float* out) {
        const Vec3 place = mesh.vertex(static_cast<std::int32_t>(v));
        if (!is_on_grid(samples.dims, place)) return false;
        const Cell cell = cell_around(samples.dims, place);
        const GridEdge edge = edge_around(cell);
        const bool on_edge = edge.axis < 3;
        Vec3 rise;
        if (!on_edge || !inner_gradient(samples, edge, rise)) rise = gradient(samples, cell);
        if (on_edge && contradicts(samples, edge, rise)) return false;
        for (double& component : rise) component *= sign;
        return store_unit(rise, out);
    });
}

template <class Real>
Array<float> triangle_normals(const MeshView<Real>& mesh) {
    check_indices(mesh.triangles, mesh.triangle_count, mesh.vertex_count);
    Array<float> normals(3 * mesh.vertex_count);
    std::vector<std::size_t> all(mesh.vertex_count);
    for (std::size_t v = 0; v < all.size(); ++v) all[v] = v;
    store_triangle_normals(mesh, all, normals.data());
    return normals;
}

template <class Real>
void store_triangle_normals(const MeshView<Real>& mesh, const std::vector<std::size_t>& wanted, float* normals) {
    Array<std::int32_t> number(mesh.vertex_count);
    std::fill(number.begin(), number.end(), -1);
    for (std::size_t n = 0; n < wanted.size(); ++n) number[wanted[n]] = static_cast<std::int32_t>(n);
    std::vector<Vec3> sums(wanted.size());
    for (std::size_t t = 0; t < mesh.triangle_count; ++t) {
        const std::int32_t* corners = mesh.triangles + 3 * t;
        std::array<std::int32_t, 3> own;
        for (std::size_t n = 0; n < 3; ++n) own[n] = number[static_cast<std::size_t>(corners[n])];
        if ((own[0] & own[1] & own[2]) == -1) continue;  // nearly always, where few are wanted
        const Vec3 normal = doubled_area(mesh, corners);
        for (const std::int32_t n : own) {
            if (n < 0) continue;
            Vec3& sum = sums[static_cast<std::size_t>(n)];
            for (std::size_t axis = 0; axis < 3; ++axis) sum[axis] += normal[axis];
        }
    }
    for (std::size_t n = 0; n < wanted.size(); ++n) {
        float* normal = normals + 3 * wanted[n];
        if (store_unit(sums[n], normal)) continue;
        normal[0] = normal[1] = 0;
        normal[2] = 1;
    }
}

#define ISOCORE_INSTANTIATE(Sample)                                                                          \
    template Array<float> gradient_normals(GridView<const Sample>, const MeshView<float>&, bool, bool, int); \
    template Array<float> gradient_normals(GridView<const Sample>, const MeshView<double>&, bool, bool, int);
ISOCORE_FOR_EACH_SAMPLE_TYPE(ISOCORE_INSTANTIATE)
#undef ISOCORE_INSTANTIATE

template Array<float> triangle_normals(const MeshView<float>&);
template Array<float> triangle_normals(const MeshView<double>&);
template void store_triangle_normals(const MeshView<float>&, const std::vector<std::size_t>&, float*);
template void store_triangle_normals(const MeshView<double>&, const std::vector<std::size_t>&, float*);

}  // namespace isocore
