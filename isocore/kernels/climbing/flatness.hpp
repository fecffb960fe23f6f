// flatness.hpp - May a box be one piece with an error of at most max_error? All crossings in it must lie in a slab no
// thicker than that, and those on a face no further from the chord of the face's iso-line. The paper has no such test:
// its boxes are as large as simplicity allows. What this test lets through is measured afterwards all the same.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "climbing/cloud.hpp"
#include "climbing/high_rice.hpp"
#include "climbing/vectors.hpp"

namespace isocore::climbing {

class Flatness {
  public:
    Flatness(double max_error, const Point& scale) : max_error_(max_error), scale_(scale) {}

    // cloud: all crossings of the closed disk box `low` ... `high`; corners: its eight signs.
    bool operator()(const Cloud& cloud, const std::array<float, 3>& low, const std::array<float, 3>& high, unsigned corners) {
        const Rim& rim = kRims[corners];
        const auto ends = find_faces(cloud, low, high);
        std::array<Point, 6> ring{};
        for (unsigned n = 0; n < rim.length; ++n) ring[n] = place(cloud, ends[rim.edges[n]]);
        Point normal{};
        for (unsigned n = 2; n < rim.length; ++n) {
            const Point part = cross(minus(ring[n - 1], ring[0]), minus(ring[n], ring[0]));
            for (std::size_t a = 0; a < 3; ++a) normal[a] += part[a];
        }
        return in_slab(cloud, ring, rim.length, normal) && near_chords(cloud, ring, rim);
    }

  private:
    static constexpr double kWorthFitting = 3;  // a slab this many times too thick is not saved by a better plane

    Point place(const Cloud& cloud, std::size_t n) const {
        return {cloud.x[n] * scale_[0], cloud.y[n] * scale_[1], cloud.z[n] * scale_[2]};
    }

    // Notes the faces of the box that each point lies on; returns the point on each crossed edge of the box.
    std::array<std::size_t, 12> find_faces(const Cloud& cloud, const std::array<float, 3>& low, const std::array<float, 3>& high) {
        std::array<std::size_t, 12> ends{};
        faces_.resize(cloud.size);
        for (std::size_t n = 0; n < cloud.size; ++n) {
            faces_[n] = static_cast<std::uint8_t>((cloud.x[n] == low[0]) | (cloud.x[n] == high[0]) << 1 | (cloud.y[n] == low[1]) << 2 |
                                                  (cloud.y[n] == high[1]) << 3 | (cloud.z[n] == low[2]) << 4 | (cloud.z[n] == high[2]) << 5);
        }
        for (std::size_t n = 0; n < cloud.size; ++n) {
            if (faces_[n] & (faces_[n] - 1)) ends[kEdgeOnFaces[faces_[n]]] = n;
        }
        return ends;
    }

    static constexpr std::array<std::uint8_t, 64> kEdgeOnFaces = [] {
        std::array<std::uint8_t, 64> edges{};
        for (int edge = 0; edge < 12; ++edge) {
            unsigned faces = 0;
            for (int face = 0; face < 6; ++face) faces |= static_cast<unsigned>(cube::edge_on_face(edge, face)) << face;
            edges[faces] = static_cast<std::uint8_t>(edge);
        }
        return edges;
    }();

    struct Slab {
        double low, high;
    };

    // The points' heights above the plane through the origin across `normal`.
    static Slab slab(const float* x, const float* y, const float* z, std::size_t size, const std::array<float, 3>& normal) {
        float low = std::numeric_limits<float>::infinity(), high = -low;
        for (std::size_t n = 0; n < size; ++n) {
            const float height = x[n] * normal[0] + y[n] * normal[1] + z[n] * normal[2];
            low = height < low ? height : low;
            high = height > high ? height : high;
        }
        return {low, high};
    }

    bool in_slab(const Cloud& cloud, const std::array<Point, 6>& ring, unsigned corners, Point normal) const {
        const double length = std::sqrt(dot(normal, normal));
        if (!(length > 0)) return false;
        for (double& n : normal) n /= length;
        double low = dot(ring[0], normal), high = low;
        for (unsigned n = 1; n < corners; ++n) {
            low = std::min(low, dot(ring[n], normal));
            high = std::max(high, dot(ring[n], normal));
        }
        if (high - low > kWorthFitting * max_error_) return false;
        double thickness = width(cloud, normal);
        if (thickness <= max_error_) return true;
        if (thickness > kWorthFitting * max_error_) return false;
        return fit(cloud, normal) && width(cloud, normal) <= max_error_;
    }

    double width(const Cloud& cloud, const Point& normal) const {
        const Slab found = slab(cloud.x, cloud.y, cloud.z, cloud.size,
                                {static_cast<float>(normal[0] * scale_[0]), static_cast<float>(normal[1] * scale_[1]),
                                 static_cast<float>(normal[2] * scale_[2])});
        return found.high - found.low;
    }

    // Turns the normal to that of the least-squares plane of heights over the plane across the old one.
    bool fit(const Cloud& cloud, Point& normal) const {
        const std::size_t least = std::abs(normal[0]) < std::abs(normal[1]) ? (std::abs(normal[0]) < std::abs(normal[2]) ? 0 : 2)
                                                                            : (std::abs(normal[1]) < std::abs(normal[2]) ? 1 : 2);
        Point u{};
        u[least] = 1;
        u = cross(normal, u);
        const double length = std::sqrt(dot(u, u));
        for (double& n : u) n /= length;
        const Point v = cross(normal, u);
        double su = 0, sv = 0, sh = 0, suu = 0, suv = 0, svv = 0, suh = 0, svh = 0;
        for (std::size_t n = 0; n < cloud.size; ++n) {
            const Point p = place(cloud, n);
            const double pu = dot(p, u), pv = dot(p, v), h = dot(p, normal);
            su += pu, sv += pv, sh += h, suu += pu * pu, suv += pu * pv, svv += pv * pv, suh += pu * h, svh += pv * h;
        }
        const double count = static_cast<double>(cloud.size);
        suu -= su * su / count, suv -= su * sv / count, svv -= sv * sv / count, suh -= su * sh / count, svh -= sv * sh / count;
        const double determinant = suu * svv - suv * suv;
        if (!(determinant > 1e-9 * suu * svv)) return false;
        const double a = (suh * svv - svh * suv) / determinant, b = (svh * suu - suh * suv) / determinant;
        for (std::size_t n = 0; n < 3; ++n) normal[n] -= a * u[n] + b * v[n];
        const double stretched = std::sqrt(dot(normal, normal));
        for (double& n : normal) n /= stretched;
        return true;
    }

    bool near_chords(const Cloud& cloud, const std::array<Point, 6>& ring, const Rim& rim) const {
        for (std::size_t p = 0; p < cloud.size; ++p) {
            if (faces_[p] == 0 || faces_[p] & (faces_[p] - 1)) continue;
            unsigned n = 0;
            while (faces_[p] != 1u << rim.faces[n]) ++n;
            const double off = squared_distance_to_segment(place(cloud, p), ring[n], ring[(n + 1) % rim.length]);
            if (off > max_error_ * max_error_) return false;
        }
        return true;
    }

    double max_error_;
    Point scale_;
    std::vector<std::uint8_t> faces_;
};

}  // namespace isocore::climbing
