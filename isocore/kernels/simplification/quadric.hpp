// quadric.hpp - The quadric error of M. Garland, P. S. Heckbert, "Surface Simplification Using Quadric Error Metrics",
// SIGGRAPH 1997: the sum of a place's squared distances from some planes, each weighted by its triangle's area. Kept
// about its own vertex, as floats suffice for small places: with absolute coordinates they would not.
#pragma once

#include <cmath>

#include "common/lanes.hpp"
#include "common/vectors.hpp"

namespace isocore::simplification {

class Quadric {
  public:
    // Adds the plane of a triangle that has the quadric's vertex as a corner. sides: from there to the other two.
    void add(const Spot& one, const Spot& other) {
        const Spot normal = cross(one, other);
        const float squared = dot(normal, normal);
        if (squared == 0) return;
        const float weight = 0.5f / std::sqrt(squared);  // times |normal|^2 is the area
        xx_ += weight * normal[0] * normal[0];
        xy_ += weight * normal[0] * normal[1];
        xz_ += weight * normal[0] * normal[2];
        yy_ += weight * normal[1] * normal[1];
        yz_ += weight * normal[1] * normal[2];
        zz_ += weight * normal[2] * normal[2];
    }

    // Adds the quadric of another vertex. way: from that vertex to this one.
    void add(const Quadric& other, const Spot& way) {
        xx_ += other.xx_;
        xy_ += other.xy_;
        xz_ += other.xz_;
        yy_ += other.yy_;
        yz_ += other.yz_;
        zz_ += other.zz_;
        const Spot turned{other.xx_ * way[0] + other.xy_ * way[1] + other.xz_ * way[2],
                          other.xy_ * way[0] + other.yy_ * way[1] + other.yz_ * way[2],
                          other.xz_ * way[0] + other.yz_ * way[1] + other.zz_ * way[2]};
        constant_ += dot(turned, way) + 2 * dot(other.linear_, way) + other.constant_;
        for (std::size_t n = 0; n < 3; ++n) linear_[n] += other.linear_[n] + turned[n];
    }

    // The error at some places, relative to the vertex.
    template <class Number>
    Number at(const Vector<Number>& p) const {
        const Number x = Number(xx_) * p[0] + Number(2 * xy_) * p[1] + Number(2 * linear_[0]);
        const Number y = Number(yy_) * p[1] + Number(2 * yz_) * p[2] + Number(2 * linear_[1]);
        const Number z = Number(zz_) * p[2] + Number(2 * xz_) * p[0] + Number(2 * linear_[2]);
        return x * p[0] + y * p[1] + z * p[2] + Number(constant_);
    }
    // The error at the vertex itself.
    float constant() const { return constant_; }
    // The area of all the triangles.
    float area() const { return xx_ + yy_ + zz_; }

  private:
    float xx_ = 0, xy_ = 0, xz_ = 0, yy_ = 0, yz_ = 0, zz_ = 0;
    Spot linear_{0, 0, 0};
    float constant_ = 0;
};

}  // namespace isocore::simplification
