// collapsed.hpp - Triangles without area, which cells draw that name a point twice.
#pragma once

#include <cstddef>
#include <cstdint>

#include "common/array.hpp"

namespace isocore {

// Removes the triangles (three vertex numbers each) that have two equal corners; the others keep their order.
inline void drop_collapsed(Array<std::int32_t>& triangles) {
    std::size_t end = 0;
    for (std::size_t n = 0; n < triangles.size(); n += 3) {
        const std::int32_t a = triangles[n], b = triangles[n + 1], c = triangles[n + 2];
        if (a == b || b == c || c == a) continue;
        triangles[end] = a;
        triangles[end + 1] = b;
        triangles[end + 2] = c;
        end += 3;
    }
    triangles.resize(end);
}

}  // namespace isocore
