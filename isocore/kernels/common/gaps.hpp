// gaps.hpp - Every task gets room for the most triangles that it may draw, so that all can write at once; afterwards
// this moves what they have drawn together.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "common/array.hpp"

namespace isocore {

// runs: one per task, in the order of their places, each with its `first_triangle` and how many `triangles` it has.
template <class Runs>
void close_gaps(const Runs& runs, Array<std::int32_t>& triangles) {
    std::size_t end = 0;
    for (const auto& run : runs) {
        if (run.first_triangle != end) {
            const auto from = triangles.begin() + static_cast<std::ptrdiff_t>(3 * run.first_triangle);
            std::copy(from, from + static_cast<std::ptrdiff_t>(3 * run.triangles),
                      triangles.begin() + static_cast<std::ptrdiff_t>(3 * end));
        }
        end += run.triangles;
    }
    triangles.resize(3 * end);
}

}  // namespace isocore
