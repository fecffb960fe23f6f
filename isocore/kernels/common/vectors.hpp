// vectors.hpp - Vectors of three numbers: floats, doubles, or several floats at once (common/lanes.hpp).
#pragma once

#include <array>
#include <cmath>

namespace isocore {

template <class Number>
using Vector = std::array<Number, 3>;

// A place as float32, in samples from an origin near by: a block's or a box's, so that few bits are spent on whole
// samples.
using Spot = Vector<float>;

template <class Number>
Vector<Number> minus(const Vector<Number>& a, const Vector<Number>& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
template <class Number>
Vector<Number> plus(const Vector<Number>& a, const Vector<Number>& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
template <class Number>
Vector<Number> times(const Number& factor, const Vector<Number>& a) {
    return {factor * a[0], factor * a[1], factor * a[2]};
}
template <class Number>
Number dot(const Vector<Number>& a, const Vector<Number>& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <class Number>
Vector<Number> cross(const Vector<Number>& a, const Vector<Number>& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// No less than the length.
inline float sum_of_sizes(const Spot& a) { return std::abs(a[0]) + std::abs(a[1]) + std::abs(a[2]); }

}  // namespace isocore
