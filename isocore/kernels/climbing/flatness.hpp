// flatness.hpp - May a box be one piece with an error of at most max_error? All crossings in it must lie in a slab no
// thicker than that, and those on a face no further from the chord of the face's iso-line. The paper has no such test:
// its boxes are as large as simplicity allows. What this test lets through is measured afterwards all the same.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "climbing/cloud.hpp"
#include "climbing/high_rice.hpp"

namespace isocore::climbing {

class Flatness {
  public:
    using Ring = std::array<Spot, 6>;  // the crossings on a box's edges, in the order of its Rim, then the first again

    explicit Flatness(double max_error) : max_error_(static_cast<float>(max_error)) {}

    // around: all crossings in the closed disk box, and perhaps others.
    bool operator()(const Cloud& around, const Extent& box, const Rim& rim, const Ring& ring) const {
        Spot normal{};
        for (std::size_t n = 2; n < ring.size(); ++n) {
            const Spot part = cross(minus(ring[n - 1], ring[0]), minus(ring[n], ring[0]));
            for (std::size_t a = 0; a < 3; ++a) normal[a] += part[a];
        }
        return normalise(normal) && in_slab(around, box, ring, normal) && near_chords(around, box, ring, rim);
    }

  private:
    // A slab this many times too thick is hardly ever saved by a better plane; nor if its corners alone make it so.
    static constexpr float kWorthFitting = 1.25f, kHopeless = 2;

    static Spot minus(const Spot& a, const Spot& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
    static float dot(const Spot& a, const Spot& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
    static Spot cross(const Spot& a, const Spot& b) {
        return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    }
    static bool normalise(Spot& a) {
        const float length = std::sqrt(dot(a, a));
        if (!(length > 0)) return false;
        const float scale = 1 / length;
        for (float& x : a) x *= scale;
        return true;
    }

    template <class Visit>
    static void each(const Cloud& cloud, const Visit& visit) {
        for (std::size_t n = 0; n < cloud.lanes; n += kLanes<float>) {
            visit(Numbers(cloud.axes[0] + n), Numbers(cloud.axes[1] + n), Numbers(cloud.axes[2] + n));
        }
    }

    bool in_slab(const Cloud& around, const Extent& box, const Ring& ring, Spot normal) const {
        float low = dot(ring[0], normal), high = low;
        for (std::size_t n = 1; n < ring.size(); ++n) {
            const float height = dot(ring[n], normal);
            low = std::min(low, height);
            high = std::max(high, height);
        }
        if (high - low > kHopeless * max_error_) return false;
        const float thickness = width(around, box, normal);
        if (thickness <= max_error_) return true;
        if (thickness > kWorthFitting * max_error_) return false;
        return fit(around, box, ring[0], normal) && width(around, box, normal) <= max_error_;
    }

    // The thickness of the slab across `normal` that holds all crossings in the box.
    static float width(const Cloud& around, const Extent& box, const Spot& normal) {
        const Numbers infinity(std::numeric_limits<float>::infinity()), minus_infinity(-std::numeric_limits<float>::infinity());
        Numbers low = infinity, high = minus_infinity;
        each(around, [&](const Numbers& x, const Numbers& y, const Numbers& z) {
            const auto here = within(box, x, y, z);
            const Numbers height = x * normal[0] + y * normal[1] + z * normal[2];
            low = least(low, choose(here, height, infinity));
            high = greatest(high, choose(here, height, minus_infinity));
        });
        const auto lows = low.each(), highs = high.each();
        return *std::max_element(highs.begin(), highs.end()) - *std::min_element(lows.begin(), lows.end());
    }

    // Turns the normal to that of the least-squares plane of heights over the plane across the old one.
    static bool fit(const Cloud& around, const Extent& box, const Spot& origin, Spot& normal) {
        std::size_t least_axis = 0;
        for (std::size_t a = 1; a < 3; ++a) {
            if (std::abs(normal[a]) < std::abs(normal[least_axis])) least_axis = a;
        }
        Spot u{};
        u[least_axis] = 1;
        u = cross(normal, u);
        normalise(u);
        const Spot v = cross(normal, u);
        std::array<Numbers, 9> sums;
        const Numbers zero(0.0f), one(1.0f);
        sums.fill(zero);
        each(around, [&](const Numbers& x, const Numbers& y, const Numbers& z) {
            const auto here = within(box, x, y, z);
            const auto along = [&](const Spot& axis) {
                return choose(here, (x - origin[0]) * axis[0] + (y - origin[1]) * axis[1] + (z - origin[2]) * axis[2], zero);
            };
            const Numbers a = along(u), b = along(v), h = along(normal);
            const std::array<Numbers, 9> parts{choose(here, one, zero), a, b, h, a * a, a * b, b * b, a * h, b * h};
            for (std::size_t n = 0; n < parts.size(); ++n) sums[n] = sums[n] + parts[n];
        });
        std::array<float, 9> sum{};
        for (std::size_t n = 0; n < sum.size(); ++n) {
            for (const float lane : sums[n].each()) sum[n] += lane;
        }
        const float a = sum[1] / sum[0], b = sum[2] / sum[0], h = sum[3] / sum[0];
        const float aa = sum[4] - sum[1] * a, ab = sum[5] - sum[1] * b, bb = sum[6] - sum[2] * b, ah = sum[7] - sum[1] * h, bh = sum[8] - sum[2] * h;
        const float determinant = aa * bb - ab * ab;
        if (!(determinant > 1e-5f * aa * bb)) return false;
        const float along_u = (ah * bb - bh * ab) / determinant, along_v = (bh * aa - ah * ab) / determinant;
        for (std::size_t n = 0; n < 3; ++n) normal[n] -= along_u * u[n] + along_v * v[n];
        return normalise(normal);
    }

    // Does every crossing on a face lie near the line through the two on the face's rim? (Between those two, as the
    // iso-lines of a face run one way along both axes.)
    bool near_chords(const Cloud& around, const Extent& box, const Ring& ring, const Rim& rim) const {
        struct Chord {
            const float* across;  // the places along the face's axis
            float side;
            Spot normal;  // not to scale
            float height, limit;
        };
        std::array<Chord, 6> chords;
        for (unsigned n = 0; n < rim.length; ++n) {
            const std::size_t axis = rim.faces[n] / 2u, u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
            const Spot along = minus(ring[n + 1 < rim.length ? n + 1 : 0], ring[n]);
            Spot normal{};
            normal[u] = -along[v];
            normal[v] = along[u];
            const float limit = max_error_ * max_error_ * dot(normal, normal);
            chords[n] = {around.axes[axis], rim.faces[n] & 1 ? box.high[axis] : box.low[axis], normal, dot(normal, ring[n]), limit};
        }
        auto far = Numbers(0.0f) < Numbers(0.0f);
        for (std::size_t n = 0; n < around.lanes; n += kLanes<float>) {
            const Numbers x(around.axes[0] + n), y(around.axes[1] + n), z(around.axes[2] + n);
            const auto here = within(box, x, y, z);
            for (unsigned c = 0; c < rim.length; ++c) {
                const auto& [across, side, normal, height, limit] = chords[c];
                const Numbers off = x * normal[0] + y * normal[1] + z * normal[2] - height;
                far = far | (here & (Numbers(across + n) == Numbers(side)) & (Numbers(limit) < off * off));
            }
        }
        return !far.any();
    }

    float max_error_;
};

}  // namespace isocore::climbing
