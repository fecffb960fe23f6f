// crossings.hpp - Visits the grid edges that the isosurface crosses within a box.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "climbing/high_rice.hpp"
#include "common/edge_vertices.hpp"
#include "common/signs.hpp"

namespace isocore::climbing {

// Calls visit(axis, i, j, k) for every crossed edge of the closed box, whose last samples are `last`; with `last` one
// less along an axis, edges in the box's high face across it are left to the box beyond.
template <class Visit>
void visit_crossings(const SignGrid& signs, const HighRice& box, const std::array<std::int32_t, 3>& last, const Visit& visit) {
    for (std::int32_t k = box.low[2]; k <= last[2]; ++k) {
        for (std::int32_t j = box.low[1]; j <= last[1]; ++j) {
            for (int axis = 0; axis < 3; ++axis) {
                if ((axis == 1 && j == box.high[1]) || (axis == 2 && k == box.high[2])) continue;
                const std::int32_t end = axis == 0 ? std::min(last[0], box.high[0] - 1) : last[0];
                for (std::int32_t w = box.low[0] / 64; w <= end / 64; ++w) {
                    const std::int32_t from = std::max(box.low[0] - 64 * w, 0), to = std::min(end - 64 * w, 63);
                    const std::uint64_t here = (~std::uint64_t{0} >> (63 - to)) & (~std::uint64_t{0} << from);
                    const auto place = [](std::int32_t n) { return static_cast<std::size_t>(n); };
                    for (std::uint64_t left = crossed_edges(signs, axis, place(j), place(k), place(w)) & here; left; left &= left - 1) {
                        visit(axis, 64 * w + std::countr_zero(left), j, k);
                    }
                }
            }
        }
    }
}

}  // namespace isocore::climbing
