// affine.hpp - Where an affine puts a place, and what is left of that once it is written.
#pragma once

#include <array>
#include <cstddef>

namespace isocore {

using Affine = std::array<double, 12>;  // (3, 4), rows first

// One coordinate of affine * (place, 1), in double.
template <class Real>
double through(const Affine& affine, const Real* place, std::size_t axis) {
    const double* const row = affine.data() + 4 * axis;
    return row[0] * static_cast<double>(place[0]) + row[1] * static_cast<double>(place[1]) +
           row[2] * static_cast<double>(place[2]) + row[3];
}

// How vertices are written: an affine turns and stretches them, and then they are rounded.
struct Writing {
    Affine affine{};
    bool is_single = false;  // as float32, else as float64
    // How far that moves a vertex along each axis at most, once it is brought back. 0: vertices stay as they are.
    double rounding = 0;

    // What is left unchanged beyond a wall meets nothing that stays so far from it, wherever both are moved.
    double margin() const { return 2 * rounding; }
    template <class Real>
    std::array<double, 3> written(const std::array<Real, 3>& place) const {
        std::array<double, 3> out;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double at = rounding > 0 ? through(affine, place.data(), axis) : static_cast<double>(place[axis]);
            out[axis] = rounding > 0 && is_single ? static_cast<double>(static_cast<float>(at)) : at;
        }
        return out;
    }
};

}  // namespace isocore
