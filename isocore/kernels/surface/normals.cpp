// normals.cpp - Vertex normals from the samples' gradient or from the triangles.
#include "surface/normals.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <vector>

#include "common/parallel.hpp"
#include "samples/sample_types.hpp"

namespace isocore {
namespace {

constexpr std::size_t kBlock = 4096;
// A corner that weighs less than this is left out, which spares its seven samples. Both ends of a crossed edge weigh at
// least four times as much (kClamp in crossing.hpp).
constexpr double kWeightless = 1.0 / 4096;

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

template <class Sample>
Vec3 gradient(const GridView<const Sample>& samples, const Vec3& place) {
    const Cell cell = cell_around(samples.dims, place);
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

// False, and nothing stored, if there is no direction in it.
bool store_unit(const Vec3& direction, float* out) {
    const double length = std::sqrt(dot(direction, direction));
    if (!(length > 0) || !std::isfinite(length)) return false;
    for (std::size_t axis = 0; axis < 3; ++axis) out[axis] = static_cast<float>(direction[axis] / length);
    return true;
}

}  // namespace

template <class Sample, class Real>
Array<float> gradient_normals(GridView<const Sample> samples, const MeshView<Real>& mesh, bool below, int threads) {
    check_indices(mesh.triangles, mesh.triangle_count, mesh.vertex_count);
    Array<float> normals(3 * mesh.vertex_count);
    const double sign = below ? 1 : -1;
    std::vector<std::vector<std::size_t>> missing((mesh.vertex_count + kBlock - 1) / kBlock);
    parallel_for(threads, missing.size(), [&](std::size_t block) {
        for (std::size_t v = block * kBlock; v < std::min(mesh.vertex_count, (block + 1) * kBlock); ++v) {
            const Vec3 place = mesh.vertex(static_cast<std::int32_t>(v));
            Vec3 normal{};
            if (is_on_grid(samples.dims, place)) normal = gradient(samples, place);
            for (double& component : normal) component *= sign;
            if (!store_unit(normal, normals.data() + 3 * v)) missing[block].push_back(v);
        }
    });
    const auto some = [](const std::vector<std::size_t>& block) { return !block.empty(); };
    if (std::none_of(missing.begin(), missing.end(), some)) return normals;
    const Array<float> others = triangle_normals(mesh);
    for (const std::vector<std::size_t>& block : missing) {
        for (const std::size_t v : block) std::copy_n(others.data() + 3 * v, 3, normals.data() + 3 * v);
    }
    return normals;
}

template <class Real>
Array<float> triangle_normals(const MeshView<Real>& mesh) {
    check_indices(mesh.triangles, mesh.triangle_count, mesh.vertex_count);
    std::vector<Vec3> sums(mesh.vertex_count);
    for (std::size_t t = 0; t < mesh.triangle_count; ++t) {
        const std::int32_t* corners = mesh.triangles + 3 * t;
        const Vec3 normal = doubled_area(mesh, corners);
        for (int corner = 0; corner < 3; ++corner) {
            Vec3& sum = sums[static_cast<std::size_t>(corners[corner])];
            for (std::size_t axis = 0; axis < 3; ++axis) sum[axis] += normal[axis];
        }
    }
    Array<float> normals(3 * mesh.vertex_count);
    for (std::size_t v = 0; v < mesh.vertex_count; ++v) {
        float* normal = normals.data() + 3 * v;
        if (store_unit(sums[v], normal)) continue;
        normal[0] = normal[1] = 0;
        normal[2] = 1;
    }
    return normals;
}

#define ISOCORE_INSTANTIATE(Sample)                                                                    \
    template Array<float> gradient_normals(GridView<const Sample>, const MeshView<float>&, bool, int); \
    template Array<float> gradient_normals(GridView<const Sample>, const MeshView<double>&, bool, int);
ISOCORE_FOR_EACH_SAMPLE_TYPE(ISOCORE_INSTANTIATE)
#undef ISOCORE_INSTANTIATE

template Array<float> triangle_normals(const MeshView<float>&);
template Array<float> triangle_normals(const MeshView<double>&);

}  // namespace isocore
