// crossings.hpp - Visits grid edges within a box of a block.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

#include "climbing/high_rice.hpp"
#include "climbing/site.hpp"

namespace isocore::climbing {

// Calls visit(axis, {i, j, k}) for every edge of the closed box, whose last samples are `last`, that edges(axis, j, k)
// has a bit for; with `last` one less along an axis, edges in the box's high face across it are left to the box beyond.
template <class Edges, class Visit>
void visit_edges(const HighRice& box, const Place& last, const Edges& edges, const Visit& visit) {
    const std::uint64_t from = ~std::uint64_t{0} << box.low[0];
    const std::uint64_t along = ~(~std::uint64_t{0} << box.high[0]) & from, across = ~(~std::uint64_t{1} << last[0]) & from;
    for (int k = box.low[2]; k <= last[2]; ++k) {
        for (int j = box.low[1]; j <= last[1]; ++j) {
            for (std::uint64_t left = edges(0, j, k) & along; left; left &= left - 1) visit(0, Place{std::countr_zero(left), j, k});
            if (j < box.high[1]) {
                for (std::uint64_t left = edges(1, j, k) & across; left; left &= left - 1) visit(1, Place{std::countr_zero(left), j, k});
            }
            if (k < box.high[2]) {
                for (std::uint64_t left = edges(2, j, k) & across; left; left &= left - 1) visit(2, Place{std::countr_zero(left), j, k});
            }
        }
    }
}

}  // namespace isocore::climbing
