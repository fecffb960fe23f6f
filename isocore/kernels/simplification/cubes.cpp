#include "simplification/cubes.hpp"

#include <algorithm>
#include <cmath>

#include "common/vectors.hpp"

namespace isocore::simplification {

Cubes::Cubes(const Cells& cells, double rounding) : cells_(cells), rounding_(rounding * cells.per_cell) {
    for (std::size_t a = 0; a < 3; ++a) dims_[a] = ((cells.dims[a] - 1) >> kBits) + 1;
}

template <class Real>
void Cubes::touched(std::array<const std::array<Real, 3>*, 3> corners, std::vector<std::int32_t>& out) const {
    // Rounding depends on which corner is the first: always the same one, or a triangle might be left in a cube.
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    std::array<std::array<float, 3>, 3> at;  // corners, in cubes from the low one
    Cell low{}, high{};
    for (std::size_t a = 0; a < 3; ++a) {
        std::array<double, 3> in_cells;
        for (std::size_t n = 0; n < 3; ++n) in_cells[n] = cells_.in_cells(static_cast<double>((*corners[n])[a]), a);
        const auto cube = [&](double place) { return cells_.clamped(place, a) >> kBits; };
        low[a] = cube(std::min({in_cells[0], in_cells[1], in_cells[2]}) - rounding_);
        high[a] = cube(std::max({in_cells[0], in_cells[1], in_cells[2]}) + rounding_);
        for (std::size_t n = 0; n < 3; ++n)
            at[n][a] = static_cast<float>(in_cells[n] / (1 << kBits) - static_cast<double>(low[a]));
    }
    if (low == high) return out.push_back(number(low));
    const Spot one = minus(at[1], at[0]), other = minus(at[2], at[0]), normal = cross(one, other);
    constexpr float kHalf = 0.5f + 1e-3f;  // of a cube, with some room for rounding
    float reach = kHalf * sum_of_sizes(normal);
    if (rounding_ > 0) {  // moves the plane, and turns it
        const auto moved = static_cast<float>(4 * rounding_ / (1 << kBits));
        const auto across = static_cast<float>(high[0] - low[0] + high[1] - low[1] + high[2] - low[2] + 3);
        reach += moved * (sum_of_sizes(normal) + (sum_of_sizes(one) + sum_of_sizes(other) + moved) * across);
    }
    for (std::int32_t k = low[2]; k <= high[2]; ++k) {
        const float z = normal[2] * (static_cast<float>(k - low[2]) + 0.5f - at[0][2]);
        for (std::int32_t j = low[1]; j <= high[1]; ++j) {
            const float yz = z + normal[1] * (static_cast<float>(j - low[1]) + 0.5f - at[0][1]);
            for (std::int32_t i = low[0]; i <= high[0]; ++i) {
                const float xyz = yz + normal[0] * (static_cast<float>(i - low[0]) + 0.5f - at[0][0]);
                if (!(std::abs(xyz) > reach)) out.push_back(number({i, j, k}));
            }
        }
    }
}

template void Cubes::touched(std::array<const std::array<float, 3>*, 3>, std::vector<std::int32_t>&) const;
template void Cubes::touched(std::array<const std::array<double, 3>*, 3>, std::vector<std::int32_t>&) const;

}  // namespace isocore::simplification
