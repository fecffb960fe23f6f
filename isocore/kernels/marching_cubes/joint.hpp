// joint.hpp - Does the trilinear function join two corners of a cell through its middle?
//
// In a slice across an axis the function is bilinear, and the asymptotic decider tells which diagonal pair of the four
// edges along the axis it joins: the sign of q(t) = A C - B D of the edges' values, a quadratic. On the cell's faces
// two groups of corners stay apart, so where a slice joins them q changes its sign and back, and its extremum lies
// between. Every part of a slice's inside reaches one of the four edges, so slices along one axis see all. The
// discriminant of q is the same for all three axes (Cayley's hyperdeterminant of the eight corners).
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

namespace isocore::marching_cubes {

struct Joint {
    int a = 0, b = 0;  // a corner of each of the joined groups; 0, 0 if there is nothing to join
};

// values: of the corners, less the isovalue; inside is >= 0. corners: their signs. The groups of the two corners may
// be one and the same.
inline Joint find_joint(const std::array<double, 8>& values, unsigned corners) {
    constexpr std::array<int, 4> kRing{0, 2, 6, 4};  // the edges along axis 0, by their lower corner
    std::array<double, 4> low, step;
    for (std::size_t n = 0; n < 4; ++n) {
        low[n] = values[static_cast<std::size_t>(kRing[n])];
        step[n] = values[static_cast<std::size_t>(kRing[n] + 1)] - low[n];
    }
    const double a = step[0] * step[2] - step[1] * step[3];
    const double b = low[0] * step[2] + low[2] * step[0] - low[1] * step[3] - low[3] * step[1];
    const double c = low[0] * low[2] - low[1] * low[3];
    // The extremum is at t = ahead / all.
    const double all = 2 * std::abs(a), ahead = a < 0 ? b : -b;
    if (!(ahead > 0 && ahead < all)) return {};
    std::array<bool, 4> in{};
    for (std::size_t n = 0; n < 4; ++n) in[n] = low[n] * (all - ahead) + (low[n] + step[n]) * ahead >= 0;
    if (in[0] != in[2] || in[1] != in[3] || in[0] == in[1]) return {};
    const double discriminant = b * b - 4 * a * c;
    const bool first_pair_wins = a < 0 ? discriminant >= 0 : discriminant <= 0;  // q(t) >= 0
    const bool inside_joined = in[0] ? first_pair_wins : (a > 0 ? discriminant >= 0 : discriminant <= 0);
    const std::size_t n = in[0] == inside_joined ? 0 : 1;
    const auto corner = [&](std::size_t edge) {
        const int at = kRing[edge];
        return (corners >> at & 1) == static_cast<unsigned>(in[edge]) ? at : at + 1;
    };
    return {corner(n), corner(n + 2)};
}

}  // namespace isocore::marching_cubes
