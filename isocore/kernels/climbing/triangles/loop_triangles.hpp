// loop_triangles.hpp - The triangles of a loop that was cut, from the corner that its parts are cut at.
#pragma once

#include <array>
#include <cstddef>

namespace isocore::climbing {

using LoopTriangle = std::array<std::size_t, 3>;  // numbers of corners
using LoopPart = std::array<std::size_t, 2>;      // between two corners

// Writes the size - 2 triangles; apex(i, j): the third corner of the one at the line from corner i to corner j. There
// is room for `size` parts.
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
