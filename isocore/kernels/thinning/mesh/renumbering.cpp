// renumbering.cpp - See renumbering.hpp. G. Morton, "A Computer Oriented Geodetic Data Base", IBM 1966.
#include "thinning/mesh/renumbering.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>
#include <vector>

namespace isocore::thinning {
namespace {

constexpr unsigned kBits = 10;  // per axis
constexpr double kSteps = 1u << kBits;

// The ten bits of a number with two zeros after each: three such numbers, shifted by 0, 1, 2, make a Morton key.
constexpr std::array<std::uint32_t, 1u << kBits> kSpread = [] {
    std::array<std::uint32_t, 1u << kBits> spread{};
    for (std::uint32_t n = 0; n < spread.size(); ++n) {
        for (unsigned bit = 0; bit < kBits; ++bit) spread[n] |= (n >> bit & 1) << 3 * bit;
    }
    return spread;
}();

struct Box {
    std::array<double, 3> low, scale;

    Box(const double* points, std::size_t size) {
        std::array<double, 3> high;
        low.fill(std::numeric_limits<double>::max());
        high.fill(std::numeric_limits<double>::lowest());
        for (std::size_t n = 0; n < size; ++n) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                low[axis] = std::min(low[axis], points[3 * n + axis]);
                high[axis] = std::max(high[axis], points[3 * n + axis]);
            }
        }
        for (std::size_t axis = 0; axis < 3; ++axis)
            scale[axis] = kSteps / std::max(high[axis] - low[axis], std::numeric_limits<double>::min());
    }

    // The step of an axis that a coordinate lies in, from 0 to kSteps - 1; 0 for NaN.
    std::uint32_t step(double place, std::size_t axis) const {
        const double steps = (place - low[axis]) * scale[axis];
        return steps > 0 ? static_cast<std::uint32_t>(std::min(steps, kSteps - 1)) : 0;
    }
};

}  // namespace

PointNumbers::PointNumbers(std::size_t points_there) : number_(points_there) {
    std::fill(number_.begin(), number_.end(), -1);
    points.reserve(points_there);
}

Array<std::uint32_t> morton_order(const double* points, std::size_t size, const std::int32_t* cells, std::size_t count,
                                  std::size_t corners) {
    const Box box(points, size);
    using Keyed = std::pair<std::uint32_t, std::uint32_t>;  // key, cell
    Array<Keyed> order(count), other(count);
    for (std::size_t cell = 0; cell < count; ++cell) {
        std::array<double, 3> middle{};
        for (std::size_t n = 0; n < corners; ++n) {
            const double* corner = points + 3 * static_cast<std::size_t>(cells[corners * cell + n]);
            for (std::size_t axis = 0; axis < 3; ++axis) middle[axis] += corner[axis];
        }
        std::uint32_t key = 0;
        for (std::size_t axis = 0; axis < 3; ++axis)
            key |= kSpread[box.step(middle[axis] / static_cast<double>(corners), axis)] << axis;
        order[cell] = {key, static_cast<std::uint32_t>(cell)};
    }
    constexpr std::uint32_t kDigit = 1u << kBits;
    for (unsigned shift = 0; shift < 3 * kBits; shift += kBits) {
        std::vector<std::size_t> start(kDigit + 1);
        for (const Keyed& keyed : order) ++start[(keyed.first >> shift & (kDigit - 1)) + 1];
        for (std::size_t n = 1; n <= kDigit; ++n) start[n] += start[n - 1];
        for (const Keyed& keyed : order) other[start[keyed.first >> shift & (kDigit - 1)]++] = keyed;
        order.swap(other);
    }
    Array<std::uint32_t> cells_in_order(count);
    for (std::size_t n = 0; n < count; ++n) cells_in_order[n] = order[n].second;
    return cells_in_order;
}

}  // namespace isocore::thinning
