// place.cpp - Element by element, so any number of threads gives the same bytes.
#include "surface/place.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "common/parallel.hpp"

namespace isocore {
namespace {

constexpr std::size_t kBlock = 16384;

template <class Body>
void for_each_block(std::size_t count, int threads, const Body& body) {
    parallel_for(threads, (count + kBlock - 1) / kBlock,
                 [&](std::size_t block) { body(block * kBlock, std::min(count, (block + 1) * kBlock)); });
}

}  // namespace

std::array<Vec3, 3> cofactors(const Affine& a) {
    const Vec3 x{a[0], a[1], a[2]}, y{a[4], a[5], a[6]}, z{a[8], a[9], a[10]};
    return {cross(y, z), cross(z, x), cross(x, y)};
}

template <class From, class To>
void place(const From* vertices, std::size_t count, const Affine& affine, To* out, int threads) {
    for_each_block(count, threads, [&, a = affine](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) {
            const std::array<From, 3> at{vertices[3 * v], vertices[3 * v + 1], vertices[3 * v + 2]};
            for (std::size_t axis = 0; axis < 3; ++axis)
                out[3 * v + axis] = static_cast<To>(through(a, at.data(), axis));
        }
    });
}

void flip(std::int32_t* triangles, std::size_t count, int threads) {
    for_each_block(count, threads, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) std::swap(triangles[3 * t + 1], triangles[3 * t + 2]);
    });
}

void turn_normals(float* normals, std::size_t count, const Affine& affine, int threads) {
    const std::array<Vec3, 3> rows = cofactors(affine);
    const double determinant = affine[0] * rows[0][0] + affine[1] * rows[0][1] + affine[2] * rows[0][2];
    if (determinant == 0 || !std::isfinite(determinant)) throw std::invalid_argument("the affine is singular");
    const double sign = determinant < 0 ? -1 : 1;
    for_each_block(count, threads, [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) {
            float* normal = normals + 3 * v;
            const Vec3 old{static_cast<double>(normal[0]), static_cast<double>(normal[1]),
                           static_cast<double>(normal[2])};
            const Vec3 turned{dot(rows[0], old), dot(rows[1], old), dot(rows[2], old)};
            const double length = std::sqrt(dot(turned, turned));
            if (!(length > 0)) continue;
            for (std::size_t axis = 0; axis < 3; ++axis)
                normal[axis] = static_cast<float>(sign * turned[axis] / length);
        }
    });
}

template void place(const float*, std::size_t, const Affine&, float*, int);
template void place(const float*, std::size_t, const Affine&, double*, int);
template void place(const double*, std::size_t, const Affine&, float*, int);
template void place(const double*, std::size_t, const Affine&, double*, int);

}  // namespace isocore
