// vectors.hpp - The little geometry that climbing needs: points in space and distances to segments and triangles.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace isocore::climbing {

using Point = std::array<double, 3>;

inline Point minus(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline double dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Point cross(const Point& a, const Point& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

inline double squared_distance_to_segment(const Point& p, const Point& a, const Point& b) {
    const Point along = minus(b, a), from = minus(p, a);
    const double length = dot(along, along);
    const double t = length > 0 ? std::clamp(dot(from, along) / length, 0.0, 1.0) : 0;
    const Point off{from[0] - t * along[0], from[1] - t * along[1], from[2] - t * along[2]};
    return dot(off, off);
}

inline double squared_distance_to_triangle(const Point& p, const Point& a, const Point& b, const Point& c) {
    const Point normal = cross(minus(b, a), minus(c, a));
    const double area = dot(normal, normal);
    if (area > 0) {
        const bool within = dot(cross(minus(b, a), minus(p, a)), normal) >= 0 && dot(cross(minus(c, b), minus(p, b)), normal) >= 0 &&
                            dot(cross(minus(a, c), minus(p, c)), normal) >= 0;
        if (within) {
            const double height = dot(minus(p, a), normal);
            return height * height / area;
        }
    }
    return std::min({squared_distance_to_segment(p, a, b), squared_distance_to_segment(p, b, c), squared_distance_to_segment(p, c, a)});
}

}  // namespace isocore::climbing
