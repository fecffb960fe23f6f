#include "simplification/cubes.hpp"

#include <algorithm>
#include <cmath>

#include "common/vectors.hpp"

namespace isocore::simplification {

Cubes::Cubes(const Cells& cells, double rounding) : cells_(cells), rounding_(rounding * cells.per_cell) {
    for (std::size_t a = 0; a < 3; ++a) {
        dims_[a] = ((cells.dims[a] - 1) >> kBits) + 1;
        // Many corners lie on walls between cells; writing is to move none of them into the next cube.
        cells_.origin[a] -= 4 * rounding;
    }
}

template <class Real>
void Cubes::touched(const std::array<const std::array<Real, 3>*, 3>& corners, std::vector<std::int32_t>& out) const {
    Cell low{}, high{};
    int axes = 0;  // along which it is in several cubes
    for (std::size_t a = 0; a < 3; ++a) {
        const auto& [one, two, three] = corners;
        const auto cube = [&](Real place, double moved) {
            return cells_.clamped(cells_.in_cells(static_cast<double>(place), a) + moved, a) >> kBits;
        };
        low[a] = cube(std::min({(*one)[a], (*two)[a], (*three)[a]}), -rounding_);
        high[a] = cube(std::max({(*one)[a], (*two)[a], (*three)[a]}), rounding_);
        axes += low[a] < high[a] ? 1 : 0;
    }
    if (axes > 1) return touched_by_plane(corners, low, high, out);
    each_cell_between(low, high, [&](const Cell& cube) { out.push_back(number(cube)); });
}

// Those from `low` to `high` that the triangle's plane passes through.
template <class Real>
void Cubes::touched_by_plane(const std::array<const std::array<Real, 3>*, 3>& corners, const Cell& low,
                             const Cell& high, std::vector<std::int32_t>& out) const {
    // Rounding depends on which corner is the first: always that which comes first in memory, or a triangle might be
    // left in a cube.
    std::size_t first = corners[1] < corners[0] ? 1 : 0;
    first = corners[2] < corners[first] ? 2 : first;
    std::array<std::array<float, 3>, 3> at;  // corners, in cubes from the low one
    for (std::size_t n = 0; n < 3; ++n) {
        const std::array<Real, 3>& corner = *corners[(first + n) % 3];
        for (std::size_t a = 0; a < 3; ++a) {
            const double in_cells = cells_.in_cells(static_cast<double>(corner[a]), a);
            at[n][a] = static_cast<float>(in_cells / (1 << kBits) - static_cast<double>(low[a]));
        }
    }
    const Spot one = minus(at[1], at[0]), other = minus(at[2], at[0]), normal = cross(one, other);
    constexpr float kHalf = 0.5f + 1e-3f;  // of a cube, with some room for rounding
    float reach = kHalf * sum_of_sizes(normal);
    if (rounding_ > 0) {  // moves the plane, and turns it
        const auto moved = static_cast<float>(4 * rounding_ / (1 << kBits));
        const auto across = static_cast<float>(high[0] - low[0] + high[1] - low[1] + high[2] - low[2] + 3);
        reach += moved * (sum_of_sizes(normal) + (sum_of_sizes(one) + sum_of_sizes(other) + moved) * across);
    }
    // Each is written down, and stays if it counts: branches would often be mispredicted.
    std::size_t count = out.size(), most = 1;
    for (std::size_t a = 0; a < 3; ++a) most *= static_cast<std::size_t>(high[a] - low[a] + 1);
    out.resize(count + most);
    for (std::int32_t k = low[2]; k <= high[2]; ++k) {
        const float z = normal[2] * (static_cast<float>(k - low[2]) + 0.5f - at[0][2]);
        for (std::int32_t j = low[1]; j <= high[1]; ++j) {
            const float yz = z + normal[1] * (static_cast<float>(j - low[1]) + 0.5f - at[0][1]);
            const std::int32_t row = number({0, j, k});
            for (std::int32_t i = low[0]; i <= high[0]; ++i) {
                const float xyz = yz + normal[0] * (static_cast<float>(i - low[0]) + 0.5f - at[0][0]);
                out[count] = row + i;
                count += static_cast<std::size_t>(!(std::abs(xyz) > reach));
            }
        }
    }
    out.resize(count);
}

template void Cubes::touched(const std::array<const std::array<float, 3>*, 3>&, std::vector<std::int32_t>&) const;
template void Cubes::touched(const std::array<const std::array<double, 3>*, 3>&, std::vector<std::int32_t>&) const;

}  // namespace isocore::simplification
