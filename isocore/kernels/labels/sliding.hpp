// sliding.hpp - How vertices are held while they are smoothed: their places, what moves them, how far they may go.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "common/array.hpp"

namespace isocore::labels {

inline constexpr float kHalfWidth = 0.45f;   // how far from its element's middle a vertex may go
inline constexpr float kSteepest = 0.3f;     // what a normal or tangent is taken to have along an axis at least
inline constexpr std::size_t kBlock = 2048;  // vertices that are sorted by their neighbours, and moved, together

// Four lanes, so that a vertex is one load and one sum: compilers that know vectors of their own are given one, because
// they leave sums of arrays to one lane after the other.
#if defined(__GNUC__)
using Lanes = float __attribute__((vector_size(16)));
#else
struct alignas(16) Lanes {
    std::array<float, 4> v{};

    float& operator[](std::size_t n) { return v[n]; }
    const float& operator[](std::size_t n) const { return v[n]; }
    Lanes& operator+=(const Lanes& other) {
        for (std::size_t n = 0; n < 4; ++n) v[n] += other.v[n];
        return *this;
    }
    friend Lanes operator+(Lanes a, const Lanes& b) { return a += b; }
    friend Lanes operator-(Lanes a, const Lanes& b) {
        for (std::size_t n = 0; n < 4; ++n) a.v[n] -= b.v[n];
        return a;
    }
    friend Lanes operator*(Lanes a, const Lanes& b) {
        for (std::size_t n = 0; n < 4; ++n) a.v[n] *= b.v[n];
        return a;
    }
    friend Lanes operator*(float factor, Lanes a) {
        for (std::size_t n = 0; n < 4; ++n) a.v[n] *= factor;
        return a;
    }
};
#endif

inline float dot(const Lanes& a, const Lanes& b) {
    const Lanes product = a * b;
    return product[0] + product[1] + product[2];
}

inline Lanes turned(const Lanes& a) { return Lanes{a[1], a[2], a[0], 0}; }

inline Lanes cross(const Lanes& a, const Lanes& b) { return turned(a * turned(b) - turned(a) * b); }

// A component of a direction, no nearer to 0 than kSteepest.
inline float steep(float component) { return std::copysign(std::max(std::abs(component), kSteepest), component); }

// Keeps a coordinate that moves inside an edge, face or cell between two samples inside of it. Vertices lie beyond -1.
inline float kept(float from, float to) {
    const float middle = static_cast<float>(static_cast<int>(from + 1.0f)) - 0.5f;
    return std::clamp(to, middle - kHalfWidth, middle + kHalfWidth);
}

// Four at a time.
inline Lanes kept(const Lanes& from, const Lanes& to) {
#if defined(__GNUC__)
    using Whole = std::int32_t __attribute__((vector_size(16)));
    const Lanes middle = __builtin_convertvector(__builtin_convertvector(from + 1.0f, Whole), Lanes) - 0.5f;
    const Lanes low = middle - kHalfWidth, high = middle + kHalfWidth;
    const Lanes raised = to < low ? low : to;
    return high < raised ? high : raised;
#else
    Lanes out;
    for (std::size_t n = 0; n < 4; ++n) out[n] = kept(from[n], to[n]);
    return out;
#endif
}

using Places = Array<Lanes>;

}  // namespace isocore::labels
