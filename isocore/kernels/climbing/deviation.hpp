// deviation.hpp - How far marching cubes' vertices lie from our surface: each is measured in one box, against the
// triangles of that box. So the true distance is never larger.
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "climbing/climb.hpp"
#include "climbing/vectors.hpp"
#include "common/lanes.hpp"

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

// Several points at once.
struct Points {
    using Numbers = Lanes<double>;
    static constexpr std::size_t kAtOnce = kLanes<double>;
    Numbers x, y, z;
};

// One triangle, prepared for many points.
class Facet {
  public:
    Facet(const Point& a, const Point& b, const Point& c) : corners_{a, b, c} {
        const Point normal = cross(minus(b, a), minus(c, a));
        height_ = plane(normal, a);
        squared_ = 1 / dot(normal, normal);
        for (std::size_t side = 0; side < 3; ++side) {
            along_[side] = minus(corners_[(side + 1) % 3], corners_[side]);
            inward_[side] = plane(cross(normal, along_[side]), corners_[side]);
            shortened_[side] = 1 / dot(along_[side], along_[side]);
        }
    }

    // The squared heights of those points that lie above or below the triangle; `beyond` for the others.
    Points::Numbers squared_heights(const Points& p, const Points::Numbers& beyond) const {
        const Points::Numbers zero(0.0), height = over(height_, p);
        const auto above = (zero <= over(inward_[0], p)) & (zero <= over(inward_[1], p)) & (zero <= over(inward_[2], p));
        return choose(above, height * height * squared_, beyond);
    }

    Points::Numbers squared_distances_to_sides(const Points& p) const {
        const Points::Numbers zero(0.0), one(1.0);
        Points::Numbers best(std::numeric_limits<double>::infinity());
        for (std::size_t side = 0; side < 3; ++side) {
            const Point &corner = corners_[side], &along = along_[side];
            const Points from{p.x - corner[0], p.y - corner[1], p.z - corner[2]};
            const Points::Numbers dot = from.x * along[0] + from.y * along[1] + from.z * along[2];
            const Points::Numbers t = least(greatest(dot * shortened_[side], zero), one);
            const Points off{from.x - t * along[0], from.y - t * along[1], from.z - t * along[2]};
            best = least(best, off.x * off.x + off.y * off.y + off.z * off.z);
        }
        return best;
    }

  private:
    struct Plane {
        Point normal;
        double offset;
    };
    static Plane plane(const Point& normal, const Point& through) { return {normal, -dot(normal, through)}; }
    static Points::Numbers over(const Plane& plane, const Points& p) {
        return p.x * plane.normal[0] + p.y * plane.normal[1] + p.z * plane.normal[2] + plane.offset;
    }

    std::array<Point, 3> corners_, along_;
    Plane height_;    // not to scale: squares of its heights are multiplied by squared_
    double squared_;
    std::array<Plane, 3> inward_;
    std::array<double, 3> shortened_;  // 1 over the squared length of each side
};

// Bounds from above on the squared distances from points to some triangles; exact but where several lie below a point.
inline Points::Numbers squared_distances(const std::vector<Facet>& facets, const Points& p) {
    const Points::Numbers infinity(std::numeric_limits<double>::infinity());
    Points::Numbers best = infinity;
    for (const Facet& facet : facets) best = least(best, facet.squared_heights(p, infinity));
    if (!(best == infinity).any()) return best;
    Points::Numbers beside = infinity;
    for (const Facet& facet : facets) beside = least(beside, facet.squared_distances_to_sides(p));
    return choose(best == infinity, beside, best);
}

}  // namespace isocore::climbing
