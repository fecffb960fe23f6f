// cubes.hpp - Cubes of two cells by two by two, and which of them a triangle touches.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "simplification/cells.hpp"

namespace isocore::simplification {

class Cubes {
  public:
    static constexpr int kBits = 1;  // a cube is this power of two of cells wide

    // rounding: how far writing moves a corner along each axis, in coordinates; a triangle touches what it then may.
    explicit Cubes(const Cells& cells, double rounding = 0);

    const Cells& cells() const { return cells_; }
    const std::array<std::size_t, 3>& dims() const { return dims_; }
    std::size_t count() const { return dims_[0] * dims_[1] * dims_[2]; }
    // The number of a cube.
    std::int32_t number(const Cell& cube) const { return static_cast<std::int32_t>(number_of(cube, dims_)); }
    // Appends the cubes that a triangle touches, by number, in ascending order, and perhaps a few that it nearly does.
    // The same for the same places. What lies outside of the cells counts to the nearest.
    template <class Real>
    void touched(const std::array<const std::array<Real, 3>*, 3>& corners, std::vector<std::int32_t>& out) const;

  private:
    template <class Real>
    void touched_by_plane(const std::array<const std::array<Real, 3>*, 3>& corners, const Cell& low, const Cell& high,
                          std::vector<std::int32_t>& out) const;

    Cells cells_;
    double rounding_;                  // in cells
    std::array<std::size_t, 3> dims_;  // in cubes
};

}  // namespace isocore::simplification
