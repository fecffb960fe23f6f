// flatness.hpp - May a box be one piece with an error of at most max_error? All crossings in it must lie in a slab no
// thicker than that, and those on a face no further from the chord of the face's iso-line. The paper has no such test:
// its boxes are as large as simplicity allows. What this test lets through is measured afterwards all the same.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "climbing/crossings/cloud.hpp"
#include "climbing/high_rice.hpp"
#include "climbing/vectors.hpp"
#include "tables/rims.hpp"

namespace isocore::climbing {

static_assert(kRimWidth == kLanes<float>);

class Flatness {
  public:
    // The crossings on a box's edges, in the order of its Rim, then the first again: where each is along its edge's
    // axis.
    using Ring = std::array<float, kLanes<float>>;

    explicit Flatness(double max_error) : max_error_(kMargin * static_cast<float>(max_error)) {}

    // around: all crossings in the closed disk box, and perhaps others. signs: those of its corners.
    bool operator()(const Cloud& around, const Extent& box, unsigned signs, const Ring& ring) const {
        const auto corners = places(box, kRimLanes[signs], ring);
        const Vector<Numbers> next{corners[0].rotated(), corners[1].rotated(), corners[2].rotated()};
        const Spot first{corners[0].first(), corners[1].first(), corners[2].first()};
        const auto normals = cross(minus(corners, {first[0], first[1], first[2]}), minus(next, corners));
        Spot normal{normals[0].sum(), normals[1].sum(), normals[2].sum()};
        return normalise(normal) && in_slab(around, box, corners, first, normal) &&
               near_chords(around, box, corners, next, signs);
    }

  private:
    // A little less than the bound, so that roundings do not have boxes halved late.
    static constexpr float kMargin = 1 - 1.0f / 65536;
    // A slab this many times too thick is hardly ever saved by a better plane.
    static constexpr float kWorthFitting = 1.25f;

    static bool normalise(Spot& a) {
        const float length = std::sqrt(dot(a, a));
        if (!(length > 0)) return false;
        const float scale = 1 / length;
        for (float& x : a) x *= scale;
        return true;
    }

    static Vector<Numbers> places(const Extent& box, const RimLanes& rim, const Ring& ring) {
        const Numbers axes(rim.axes.data()), along(ring.data());
        Vector<Numbers> out;
        for (std::size_t a = 0; a < 3; ++a) {
            const auto at_end = choose(Numbers(rim.high[a].data()) == 0.0f, Numbers(box.low[a]), Numbers(box.high[a]));
            out[a] = choose(axes == static_cast<float>(a), along, at_end);
        }
        return out;
    }

    template <class Visit>
    static void each(const Cloud& cloud, const Visit& visit) {
        for (std::size_t n = 0; n < cloud.lanes; n += kLanes<float>) {
            visit(Numbers(cloud.axes[0] + n), Numbers(cloud.axes[1] + n), Numbers(cloud.axes[2] + n));
        }
    }

    bool in_slab(const Cloud& around, const Extent& box, const Vector<Numbers>& corners, const Spot& first,
                 Spot normal) const {
        const Numbers heights = over(normal, corners[0], corners[1], corners[2]);
        if (heights.greatest_lane() - heights.least_lane() > kWorthFitting * max_error_) return false;
        const float thickness = width(around, box, normal);
        if (thickness <= max_error_) return true;
        if (thickness > kWorthFitting * max_error_) return false;
        return fit(around, box, first, normal) && width(around, box, normal) <= max_error_;
    }

    // The thickness of the slab across `normal` that holds all crossings in the box.
    static float width(const Cloud& around, const Extent& box, const Spot& normal) {
        const Numbers infinity(std::numeric_limits<float>::infinity()),
            minus_infinity(-std::numeric_limits<float>::infinity());
        Numbers low = infinity, high = minus_infinity;
        each(around, [&](const Numbers& x, const Numbers& y, const Numbers& z) {
            const auto here = within(box, x, y, z);
            const Numbers height = over(normal, x, y, z);
            low = least(low, choose(here, height, infinity));
            high = greatest(high, choose(here, height, minus_infinity));
        });
        return high.greatest_lane() - low.least_lane();
    }
    static Numbers over(const Spot& normal, const Numbers& x, const Numbers& y, const Numbers& z) {
        return x * normal[0] + y * normal[1] + z * normal[2];
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
                return choose(here, (x - origin[0]) * axis[0] + (y - origin[1]) * axis[1] + (z - origin[2]) * axis[2],
                              zero);
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
        const float aa = sum[4] - sum[1] * a, ab = sum[5] - sum[1] * b, bb = sum[6] - sum[2] * b,
                    ah = sum[7] - sum[1] * h, bh = sum[8] - sum[2] * h;
        const float determinant = aa * bb - ab * ab;
        if (!(determinant > 1e-5f * aa * bb)) return false;
        const float along_u = (ah * bb - bh * ab) / determinant, along_v = (bh * aa - ah * ab) / determinant;
        for (std::size_t n = 0; n < 3; ++n) normal[n] -= along_u * u[n] + along_v * v[n];
        return normalise(normal);
    }

    // Does every crossing on a face lie near the line through the two on the face's rim? (Between those two, as the
    // iso-lines of a face run one way along both axes.)
    bool near_chords(const Cloud& around, const Extent& box, const Vector<Numbers>& from, const Vector<Numbers>& to,
                     unsigned signs) const {
        const Rim& rim = kRims[signs];
        // The normals of the chords within their faces, not to scale.
        const auto along = minus(to, from);
        const Numbers zero(0.0f), axis(kRimLanes[signs].face_axes.data());
        const auto x = axis == 0.0f, y = axis == 1.0f;
        const Vector<Numbers> normals{choose(x, zero, choose(y, along[2], along[1])),
                                      choose(y, zero, choose(x, along[2], zero - along[0])),
                                      choose(x, zero - along[1], choose(y, zero - along[0], zero))};
        const auto normals_x = normals[0].each(), normals_y = normals[1].each(), normals_z = normals[2].each();
        const auto heights = dot(normals, from).each(),
                   limits = (dot(normals, normals) * (max_error_ * max_error_)).each();
        auto far = zero < zero;
        for (std::size_t n = 0; n < around.lanes; n += kLanes<float>) {
            const Vector<Numbers> spots{Numbers(around.axes[0] + n), Numbers(around.axes[1] + n),
                                        Numbers(around.axes[2] + n)};
            const auto here = within(box, spots[0], spots[1], spots[2]);
            for (std::size_t c = 0; c < rim.length; ++c) {
                const unsigned face = rim.faces[c];
                const Numbers off =
                    over({normals_x[c], normals_y[c], normals_z[c]}, spots[0], spots[1], spots[2]) - heights[c];
                const auto on_face = Numbers(around.axes[face / 2] + n) == (face & 1 ? box.high : box.low)[face / 2];
                far = far | (here & on_face & (Numbers(limits[c]) < off * off));
            }
        }
        return !far.any();
    }

    float max_error_;
};

}  // namespace isocore::climbing
