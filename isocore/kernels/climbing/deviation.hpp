// deviation.hpp - How far marching cubes' vertices lie from our surface: each is measured in one box, against the
// triangles of that box. So the true distance is never larger.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "climbing/climb.hpp"
#include "climbing/vectors.hpp"

namespace isocore::climbing {

inline void add(Deviation& sum, double distance) {
    sum.max = std::max(sum.max, distance);
    sum.sum += distance;
    sum.squares += distance * distance;
}

inline void add(Deviation& sum, const Deviation& other) {
    sum.max = std::max(sum.max, other.max);
    sum.sum += other.sum;
    sum.squares += other.squares;
}

// One triangle, prepared for many points.
class Facet {
  public:
    Facet(const Point& a, const Point& b, const Point& c) : corners_{a, b, c} {
        const Point normal = cross(minus(b, a), minus(c, a));
        const double length = std::sqrt(dot(normal, normal));
        for (std::size_t n = 0; n < 3; ++n) normal_[n] = normal[n] / length;
        for (std::size_t side = 0; side < 3; ++side) inward_[side] = cross(normal_, minus(corners_[(side + 1) % 3], corners_[side]));
    }

    bool is_above(const Point& p) const {
        for (std::size_t side = 0; side < 3; ++side) {
            if (!(dot(inward_[side], minus(p, corners_[side])) >= 0)) return false;
        }
        return true;
    }
    double height(const Point& p) const { return std::abs(dot(normal_, minus(p, corners_[0]))); }
    double squared_distance_to_sides(const Point& p) const {
        return std::min({squared_distance_to_segment(p, corners_[0], corners_[1]), squared_distance_to_segment(p, corners_[1], corners_[2]),
                         squared_distance_to_segment(p, corners_[2], corners_[0])});
    }

  private:
    std::array<Point, 3> corners_;
    Point normal_;
    std::array<Point, 3> inward_;
};

// A bound from above on the distance from a point to some triangles; exact but where several lie below it.
inline double distance_to(const std::vector<Facet>& facets, const Point& p) {
    double best = std::numeric_limits<double>::infinity();
    for (const Facet& facet : facets) {
        if (facet.is_above(p)) best = std::min(best, facet.height(p));
    }
    if (std::isfinite(best)) return best;
    for (const Facet& facet : facets) best = std::min(best, facet.squared_distance_to_sides(p));
    return std::sqrt(best);
}

}  // namespace isocore::climbing
