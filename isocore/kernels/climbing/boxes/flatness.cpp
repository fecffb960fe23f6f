// How a box is tested. The first normal is the vector area of the loop of crossings on the box's edges; if the slab
// across it is a little too thick, the normal is fitted to all crossings by least squares, once.
#include "climbing/boxes/flatness.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "common/inlined.hpp"
#include "tables/rims.hpp"

namespace isocore::climbing {
namespace {

static_assert(kRimWidth == kLanes);

// A slab that is this many times too thick is hardly ever saved by a better plane.
constexpr float kWorthFitting = 1.25f;

// Makes a vector one unit long; false if it has no direction (its length is 0 or NaN).
bool normalise(Spot& a) {
    const float length = std::sqrt(dot(a, a));
    if (!(length > 0)) return false;
    const float scale = 1 / length;
    for (float& x : a) x *= scale;
    return true;
}

// The crossings on the edges of a box, one lane each.
Vector<Floats> places(const Extent& box, const RimLanes& rim, const Flatness::Ring& ring) {
    const Floats axes(rim.axes.data()), along(ring.data());
    Vector<Floats> out;
    for (std::size_t a = 0; a < 3; ++a) {
        const auto at_end = choose(Floats(rim.high[a].data()) == 0.0f, Floats(box.low[a]), Floats(box.high[a]));
        out[a] = choose(axes == static_cast<float>(a), along, at_end);
    }
    return out;
}

// Calls visit(x, y, z) for a register full of the cloud's spots after the other.
template <class Visit>
void each(const Cloud& cloud, const Visit& visit) {
    for (std::size_t n = 0; n < cloud.lanes; n += kLanes) {
        visit(Floats(cloud.axes[0] + n), Floats(cloud.axes[1] + n), Floats(cloud.axes[2] + n));
    }
}

// How far spots lie along a normal.
Floats over(const Spot& normal, const Floats& x, const Floats& y, const Floats& z) {
    return x * normal[0] + y * normal[1] + z * normal[2];
}

// The thickness of the slab across `normal` that holds all crossings in the box.
float width(const Cloud& around, const Extent& box, const Spot& normal) {
    const Floats infinity(std::numeric_limits<float>::infinity()),
        minus_infinity(-std::numeric_limits<float>::infinity());
    Floats low = infinity, high = minus_infinity;
    each(around, [&](const Floats& x, const Floats& y, const Floats& z) {
        const auto here = within(box, x, y, z);
        const Floats height = over(normal, x, y, z);
        low = least(low, choose(here, height, infinity));
        high = greatest(high, choose(here, height, minus_infinity));
    });
    return high.greatest_lane() - low.least_lane();
}

// Sums over the crossings of a box, from which a plane is fitted. a, b and h are a crossing's coordinates along u, v
// and the old normal.
struct Sums {
    enum : std::size_t { one, a, b, h, aa, ab, bb, ah, bh, kCount };
    std::array<float, kCount> of{};
};

Sums sum_crossings(const Cloud& around, const Extent& box, const Spot& origin, const Spot& u, const Spot& v,
                   const Spot& normal) {
    std::array<Floats, Sums::kCount> lanes;
    const Floats zero(0.0f), one(1.0f);
    lanes.fill(zero);
    each(around, [&](const Floats& x, const Floats& y, const Floats& z) {
        const auto here = within(box, x, y, z);
        const auto along = [&](const Spot& axis) {
            return choose(here, (x - origin[0]) * axis[0] + (y - origin[1]) * axis[1] + (z - origin[2]) * axis[2],
                          zero);
        };
        const Floats a = along(u), b = along(v), h = along(normal);
        const std::array<Floats, Sums::kCount> parts{
            choose(here, one, zero), a, b, h, a * a, a * b, b * b, a * h, b * h};
        for (std::size_t n = 0; n < parts.size(); ++n) lanes[n] = lanes[n] + parts[n];
    });
    Sums sums;
    for (std::size_t n = 0; n < sums.of.size(); ++n) {
        for (const float lane : lanes[n].each()) sums.of[n] += lane;
    }
    return sums;
}

// Turns the normal to that of the least-squares plane of heights over the plane across the old normal, through normal
// equations about the mean. False if the crossings lie so nearly on a line that no plane is defined.
bool fit(const Cloud& around, const Extent& box, const Spot& origin, Spot& normal) {
    std::size_t least_axis = 0;
    for (std::size_t a = 1; a < 3; ++a) {
        if (std::abs(normal[a]) < std::abs(normal[least_axis])) least_axis = a;
    }
    Spot u{};
    u[least_axis] = 1;
    u = cross(normal, u);
    normalise(u);
    const Spot v = cross(normal, u);
    const auto sum = sum_crossings(around, box, origin, u, v, normal).of;
    const float a = sum[Sums::a] / sum[Sums::one], b = sum[Sums::b] / sum[Sums::one], h = sum[Sums::h] / sum[Sums::one];
    const float aa = sum[Sums::aa] - sum[Sums::a] * a, ab = sum[Sums::ab] - sum[Sums::a] * b,
                bb = sum[Sums::bb] - sum[Sums::b] * b, ah = sum[Sums::ah] - sum[Sums::a] * h,
                bh = sum[Sums::bh] - sum[Sums::b] * h;
    const float determinant = aa * bb - ab * ab;
    if (!(determinant > 1e-5f * aa * bb)) return false;
    const float along_u = (ah * bb - bh * ab) / determinant, along_v = (bh * aa - ah * ab) / determinant;
    for (std::size_t n = 0; n < 3; ++n) normal[n] -= along_u * u[n] + along_v * v[n];
    return normalise(normal);
}

}  // namespace

// Do all crossings in the box lie in a slab that is thin enough? The slab is across `normal`, or across a normal that
// is fitted to the crossings if that promises to help. `corners` are the crossings on the box's edges, `first` is the
// first of them.
ISOCORE_INLINED bool Flatness::in_slab(const Cloud& around, const Extent& box, const Vector<Floats>& corners,
                                       const Spot& first, Spot normal) const {
    const Floats heights = over(normal, corners[0], corners[1], corners[2]);
    if (heights.greatest_lane() - heights.least_lane() > kWorthFitting * max_error_) return false;
    const float thickness = width(around, box, normal);
    if (thickness <= max_error_) return true;
    if (thickness > kWorthFitting * max_error_) return false;
    return fit(around, box, first, normal) && width(around, box, normal) <= max_error_;
}

// Does every crossing on a face of the box lie near the chord, the line through the two crossings on the face's rim?
// (It then lies near the segment between the two, because the iso-lines of a face are monotone along both axes.) Lane n
// of `from` and `to` is the n-th chord of the box's rim.
ISOCORE_INLINED bool Flatness::near_chords(const Cloud& around, const Extent& box, const Vector<Floats>& from,
                                           const Vector<Floats>& to, unsigned signs) const {
    const Rim& rim = kRims[signs];
    // Vectors across the chords within their faces, as long as the chords: (x, y) becomes (y, -x).
    const auto along = minus(to, from);
    const Floats zero(0.0f), axis(kRimLanes[signs].face_axes.data());
    const auto x = axis == 0.0f, y = axis == 1.0f;
    const Vector<Floats> normals{choose(x, zero, choose(y, along[2], along[1])),
                                 choose(y, zero, choose(x, along[2], zero - along[0])),
                                 choose(x, zero - along[1], choose(y, zero - along[0], zero))};
    const auto normals_x = normals[0].each(), normals_y = normals[1].each(), normals_z = normals[2].each();
    const auto heights = dot(normals, from).each(), limits = (dot(normals, normals) * (max_error_ * max_error_)).each();
    auto far = zero < zero;
    for (std::size_t n = 0; n < around.lanes; n += kLanes) {
        const Vector<Floats> spots{Floats(around.axes[0] + n), Floats(around.axes[1] + n), Floats(around.axes[2] + n)};
        const auto here = within(box, spots[0], spots[1], spots[2]);
        for (std::size_t c = 0; c < rim.length; ++c) {
            const unsigned face = rim.faces[c];
            const Floats off =
                over({normals_x[c], normals_y[c], normals_z[c]}, spots[0], spots[1], spots[2]) - heights[c];
            const auto on_face = Floats(around.axes[face / 2] + n) == (face & 1 ? box.high : box.low)[face / 2];
            far = far | (here & on_face & (Floats(limits[c]) < off * off));
        }
    }
    return !far.any();
}

bool Flatness::operator()(const Cloud& around, const Extent& box, unsigned signs, const Ring& ring) const {
    const auto corners = places(box, kRimLanes[signs], ring);
    const Vector<Floats> next{corners[0].rotated(), corners[1].rotated(), corners[2].rotated()};
    const Spot first{corners[0].first(), corners[1].first(), corners[2].first()};
    const auto normals = cross(minus(corners, {first[0], first[1], first[2]}), minus(next, corners));
    Spot normal{normals[0].sum(), normals[1].sum(), normals[2].sum()};
    return normalise(normal) && in_slab(around, box, corners, first, normal) &&
           near_chords(around, box, corners, next, signs);
}

}  // namespace isocore::climbing
