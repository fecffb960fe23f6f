// unit.hpp - Unit normals, and those of the triangles where there are no better ones.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "common/array.hpp"
#include "common/parallel.hpp"
#include "surface/mesh_view.hpp"
#include "surface/normals.hpp"

namespace isocore {

// False, and nothing stored, if there is no direction in it.
inline bool store_unit(const Vec3& direction, float* out) {
    const double length = std::sqrt(dot(direction, direction));
    if (!(length > 0) || !std::isfinite(length)) return false;
    for (std::size_t axis = 0; axis < 3; ++axis) out[axis] = static_cast<float>(direction[axis] / length);
    return true;
}

// Brings the normals that are not numbers to those of the triangles.
template <class Real>
void complete_normals(const MeshView<Real>& mesh, float* normals) {
    std::vector<std::size_t> missing;
    for (std::size_t v = 0; v < mesh.vertex_count; ++v) {
        if (std::isnan(normals[3 * v])) missing.push_back(v);
    }
    if (!missing.empty()) store_triangle_normals(mesh, missing, normals);
}

// store(v, place) writes the normal of vertex v, or returns false: then it is that of the triangles, or no numbers if
// normals are not to be complete.
template <class Real, class Store>
Array<float> stored_normals(const MeshView<Real>& mesh, bool complete, int threads, const Store& store) {
    constexpr std::size_t kBlock = 4096;
    Array<float> normals(3 * mesh.vertex_count);
    parallel_for(threads, (mesh.vertex_count + kBlock - 1) / kBlock, [&](std::size_t block) {
        for (std::size_t v = block * kBlock; v < std::min(mesh.vertex_count, (block + 1) * kBlock); ++v) {
            float* const normal = normals.data() + 3 * v;
            if (!store(v, normal)) std::fill_n(normal, 3, std::numeric_limits<float>::quiet_NaN());
        }
    });
    if (complete) complete_normals(mesh, normals.data());
    return normals;
}

}  // namespace isocore
