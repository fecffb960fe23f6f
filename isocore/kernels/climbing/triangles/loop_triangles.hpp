// loop_triangles.hpp - Turns the table that dynamic programming leaves behind into a list of triangles.
#pragma once

#include <array>
#include <cstddef>

namespace isocore::climbing {

using LoopTriangle = std::array<std::size_t, 3>;  // three corners of a loop, by number
using LoopPart = std::array<std::size_t, 2>;      // the corners i, i + 1 ... j of a loop, closed by a line from i to j

// Writes the size - 2 triangles of a loop of `size` corners to `out`. apex(i, j) is the third corner of the triangle on
// the line that closes part (i, j). The parts that are still to be listed are a stack in `parts`, which has room for
// `size`. A part of two corners is a side of the loop and has no triangle: it is written to the stack, but not kept, so
// that no branch depends on it.
template <class Apex>
void list_triangles(std::size_t size, const Apex& apex, LoopPart* parts, LoopTriangle* out) {
    parts[0] = {0, size - 1};
    for (std::size_t listed = 0, top = 1; listed < size - 2; ++listed) {
        const auto [i, j] = parts[--top];
        const std::size_t k = apex(i, j);
        out[listed] = {i, k, j};
        parts[top] = {i, k};
        top += k - i > 1;
        parts[top] = {k, j};
        top += j - k > 1;
    }
}

}  // namespace isocore::climbing
