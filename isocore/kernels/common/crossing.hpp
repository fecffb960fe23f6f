// crossing.hpp - The only place where it is decided who is inside and where an edge is crossed, and how an ambiguous
// face is joined: the three rules that all algorithms share, so that all of them agree to the last bit. There is no
// other epsilon in the kernels than the clamp below.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>

namespace isocore {

// A vertex keeps this share of its edge away from both ends, so that a sample equal to the isovalue gives no
// triangle without area, and welding by position is safe.
inline constexpr double kClamp = 1.0 / 1024;

// Inside is lowest <= sample <= highest: the isovalue rounded to the sample type once, so that the test runs in
// that type. Infinities and NaN are outside. `below` turns the rule over for a negative slope (module volume.py).
template <class Sample>
struct Inside {
    Sample lowest, highest;
    bool nothing = false;

    Inside(double isovalue, bool below) {
        constexpr Sample kMin = std::numeric_limits<Sample>::lowest(), kMax = std::numeric_limits<Sample>::max();
        lowest = kMin;
        highest = kMax;
        if (below) {
            if (isovalue < static_cast<double>(kMin))
                nothing = true;
            else if (isovalue < static_cast<double>(kMax))
                highest = rounded(isovalue, false);
        } else {
            if (isovalue > static_cast<double>(kMax))
                nothing = true;
            else if (isovalue > static_cast<double>(kMin))
                lowest = rounded(isovalue, true);
        }
    }

    bool operator()(Sample sample) const { return !nothing & (sample >= lowest) & (sample <= highest); }

  private:
    // The nearest sample value at or above (up) or at or below the isovalue.
    static Sample rounded(double isovalue, bool up) {
        if constexpr (std::is_integral_v<Sample>) {
            return static_cast<Sample>(up ? std::ceil(isovalue) : std::floor(isovalue));
        } else {
            Sample nearest = static_cast<Sample>(isovalue);
            if (up && static_cast<double>(nearest) < isovalue)
                nearest = std::nextafter(nearest, std::numeric_limits<Sample>::infinity());
            if (!up && static_cast<double>(nearest) > isovalue)
                nearest = std::nextafter(nearest, -std::numeric_limits<Sample>::infinity());
            return nearest;
        }
    }
};

// Where the isosurface crosses an edge, as a share of the way from sample a to sample b; a comes before b in
// index order, so that all cells around the edge agree to the last bit.
template <class Sample>
double crossing(Sample a, Sample b, double isovalue) {
    const double fa = static_cast<double>(a), fb = static_cast<double>(b), across = fb - fa;
    if constexpr (std::is_floating_point_v<Sample>) {
        if (!std::isfinite(across)) {  // so a sample is not finite, or doubles are too far apart
            if (!std::isfinite(a) || !std::isfinite(b)) return 0.5;
            return crossing(fa / 4, fb / 4, isovalue / 4);
        }
    }
    const double t = (isovalue - fa) / across, above = t > kClamp ? t : kClamp;  // a conditional move
    return above < 1 - kClamp ? above : 1 - kClamp;
}

// As inside_corners_joined, for two inside corners and then two outside, of any finite size: the largest difference to
// the isovalue is brought near 1.
inline bool joined_in_another_scale(std::array<double, 4> corners, double isovalue) {
    double largest = std::abs(isovalue);
    for (const double corner : corners) largest = std::max(largest, std::abs(corner));
    const double share = largest > 1e300 ? 0.25 : 1;  // no difference of two quarters is too large
    largest = 0;
    for (double& corner : corners) {
        corner = share * corner - share * isovalue;
        largest = std::max(largest, std::abs(corner));
    }
    int exponent = 0;
    std::frexp(largest, &exponent);
    for (double& corner : corners) corner = std::ldexp(corner, -exponent);
    return corners[0] * corners[1] >= corners[2] * corners[3];
}

// The asymptotic decider (Nielson, Hamann 1991) on a face whose diagonal corners `in0`, `in1` are inside and
// `out0`, `out1` outside: are the inside corners joined across the face? They are iff the bilinear saddle is not
// below the isovalue, which for this sign pattern is a comparison of two products. Symmetric in its corners, so both
// cells of a face agree. Corners with a non-finite value keep the inside corners apart.
inline bool inside_corners_joined(double in0, double in1, double out0, double out1, double isovalue) {
    if (!(std::isfinite(in0) && std::isfinite(in1) && std::isfinite(out0) && std::isfinite(out1))) return false;
    const double inner = (in0 - isovalue) * (in1 - isovalue), outer = (out0 - isovalue) * (out1 - isovalue);
    // What lies beyond a double's largest or below its smallest numbers is compared in another scale.
    if (inner + outer < 1e300 && (inner > 1e-290 || outer > 1e-290)) return inner >= outer;
    return joined_in_another_scale({in0, in1, out0, out1}, isovalue);
}

}  // namespace isocore
