// mesh_view.hpp - A view of triangles and their vertices, as the kernels of this folder take it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <stdexcept>

namespace isocore {

template <class Real>
struct MeshView {
    const Real* vertices;  // (vertex_count, 3)
    std::size_t vertex_count;
    const std::int32_t* triangles;  // (triangle_count, 3)
    std::size_t triangle_count;

    std::array<double, 3> vertex(std::int32_t v) const {
        const Real* p = vertices + 3 * static_cast<std::size_t>(v);
        return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
    }
};

// Throws std::invalid_argument if a triangle names a vertex that is not there.
inline void check_indices(const std::int32_t* triangles, std::size_t triangle_count, std::size_t vertex_count) {
    std::uint32_t largest = 0;
    for (std::size_t i = 0; i < 3 * triangle_count; ++i) {
        const auto index = static_cast<std::uint32_t>(triangles[i]);
        largest = index > largest ? index : largest;
    }
    if (triangle_count > 0 && largest >= vertex_count) {
        throw std::invalid_argument("a triangle names a vertex that does not exist");
    }
}

using Vec3 = std::array<double, 3>;

inline Vec3 operator-(const Vec3& a, const Vec3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline double dot(const Vec3& a, const Vec3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Vec3 cross(const Vec3& a, const Vec3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// A normal, twice the triangle's area long, pointing to where it turns counter-clockwise.
template <class Real>
Vec3 doubled_area(const MeshView<Real>& mesh, const std::int32_t* corners) {
    const Vec3 a = mesh.vertex(corners[0]);
    return cross(mesh.vertex(corners[1]) - a, mesh.vertex(corners[2]) - a);
}

}  // namespace isocore
