// unit.hpp - Unit normals, and those of the triangles where there are no better ones.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
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

// store(v, place) writes the normal of vertex v, or returns false: then it is that of the triangles.
template <class Real, class Store>
Array<float> completed_normals(const MeshView<Real>& mesh, int threads, const Store& store) {
    constexpr std::size_t kBlock = 4096;
    Array<float> normals(3 * mesh.vertex_count);
    std::vector<std::vector<std::size_t>> missing((mesh.vertex_count + kBlock - 1) / kBlock);
    parallel_for(threads, missing.size(), [&](std::size_t block) {
        for (std::size_t v = block * kBlock; v < std::min(mesh.vertex_count, (block + 1) * kBlock); ++v) {
            if (!store(v, normals.data() + 3 * v)) missing[block].push_back(v);
        }
    });
    std::vector<std::size_t> all;
    for (const std::vector<std::size_t>& block : missing) all.insert(all.end(), block.begin(), block.end());
    if (!all.empty()) store_triangle_normals(mesh, all, normals.data());
    return normals;
}

}  // namespace isocore
