#include "common/facets.hpp"

#include <algorithm>
#include <limits>

namespace isocore {

void Facets::find_frames() {
    for (std::size_t first = 0; first < size_; first += kLanes) find_frames(first);
}

// The frames of triangle `first` and of those that follow it, one in each lane. The axis v is found by Gram-Schmidt
// orthogonalisation: from the side a c, its part along u is subtracted. Triangles may be a thousand times longer than
// wide; then one pass leaves a rest along u by rounding that is large beside v, and a second pass removes it.
void Facets::find_frames(std::size_t first) {
    const auto corner = [&](std::size_t column) -> Vector<Floats> {
        return {in_lanes(column, first), in_lanes(column + 1, first), in_lanes(column + 2, first)};
    };
    const auto a = corner(kCornerA), bottom = minus(corner(kCornerB), a), left = minus(corner(kCornerC), a);
    const Floats one(1.0f), length = root(dot(bottom, bottom));
    const auto axis_u = times(one / length, bottom);
    const Floats top_u = dot(left, axis_u);
    const auto one_pass = minus(left, times(top_u, axis_u)),
               rise = minus(one_pass, times(dot(one_pass, axis_u), axis_u));
    const Floats top_v = root(dot(rise, rise));
    const auto axis_v = times(one / top_v, rise), axis_h = cross(axis_u, axis_v);

    const auto set = [&](std::size_t column, const Floats& numbers) { numbers.store(columns_[column].data() + first); };
    for (std::size_t n = 0; n < 3; ++n) {
        set(kAxisU + n, axis_u[n]);
        set(kAxisV + n, axis_v[n]);
        set(kAxisH + n, axis_h[n]);
    }
    set(kLength, length);
    set(kTopU, top_u);
    set(kTopV, top_v);
    set(kPerRight, one / (top_v * top_v + (top_u - length) * (top_u - length)));
    set(kPerLeft, one / (top_v * top_v + top_u * top_u));
}

void Facets::squared_distances(std::size_t first, std::size_t count, const Vector<const float*>& points,
                               std::size_t size, float* out) const {
    // Lanes hold triangles or points, whichever takes fewer registers in all. The bits that come out are the same.
    const auto registers = [](std::size_t n) { return (n + kLanes - 1) / kLanes; };
    if (size * registers(count) < registers(size) * count) {
        for (std::size_t n = 0; n < size; ++n)
            out[n] = from_point(first, count, {points[0][n], points[1][n], points[2][n]});
    } else {
        for (std::size_t n = 0; n < size; n += kLanes) {
            from_points(first, count, {Floats(points[0] + n), Floats(points[1] + n), Floats(points[2] + n)})
                .store(out + n);
        }
    }
}

// From several points, one in each lane, to the nearest triangle: one triangle after the other.
auto Facets::from_points(std::size_t first, std::size_t count, const Vector<Floats>& points) const -> Floats {
    Floats best(std::numeric_limits<float>::infinity());
    for (std::size_t n = first; n < first + count; ++n)
        best = least(best, squared_distances([&](std::size_t column) { return Floats(columns_[column][n]); }, points));
    return best;
}

// From one point, in all lanes, to the nearest triangle: several triangles at once.
float Facets::from_point(std::size_t first, std::size_t count, const Vector<Floats>& point) const {
    const Floats infinity(std::numeric_limits<float>::infinity());
    Floats best = infinity;
    for (std::size_t n = 0; n < count; n += kLanes) {
        const Floats to_each =
            squared_distances([&](std::size_t column) { return in_lanes(column, first + n); }, point);
        best = least(best, first_lanes(to_each, std::min(kLanes, count - n), infinity));
    }
    return best.least_lane();
}

auto Facets::frame(std::size_t triangle) const -> Frame {
    const auto get = [&](std::size_t column) { return columns_[column][triangle]; };
    const auto vector = [&](std::size_t column) -> Spot { return {get(column), get(column + 1), get(column + 2)}; };
    return {vector(kCornerA), vector(kAxisU), vector(kAxisV), vector(kAxisH), get(kLength), get(kTopU), get(kTopV)};
}

}  // namespace isocore
