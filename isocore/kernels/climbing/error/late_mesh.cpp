#include "climbing/error/late_mesh.hpp"

#include <algorithm>

namespace isocore::climbing {

template <class Coordinate>
void make_room(const std::vector<LateVertex>& late, Array<Coordinate>& vertices) {
    auto end = static_cast<std::ptrdiff_t>(vertices.size());
    vertices.resize(vertices.size() + 3 * late.size());
    auto moved = static_cast<std::ptrdiff_t>(3 * late.size());
    for (std::size_t n = late.size(); n-- > 0; moved -= 3) {
        const auto from = static_cast<std::ptrdiff_t>(3 * (late[n].vertex - n));
        std::move_backward(vertices.begin() + from, vertices.begin() + end, vertices.begin() + end + moved);
        end = from;
    }
}

template void make_room(const std::vector<LateVertex>&, Array<float>&);
template void make_room(const std::vector<LateVertex>&, Array<double>&);

void renumber(const std::vector<LateVertex>& late, std::span<std::int32_t> vertices) {
    std::vector<std::int32_t> first_moved;  // for each late vertex, the old number of the vertex that follows it
    for (const LateVertex& vertex : late)
        first_moved.push_back(static_cast<std::int32_t>(vertex.vertex - first_moved.size()));
    for (std::int32_t& vertex : vertices) {
        vertex += static_cast<std::int32_t>(std::upper_bound(first_moved.begin(), first_moved.end(), vertex) -
                                            first_moved.begin());
    }
}

void move_triangles(const std::vector<std::size_t>& before, const Redrawn& redrawn, const Bars& bars,
                    Array<std::int32_t>& triangles) {
    const auto at = [&](std::size_t triangle) { return triangles.begin() + static_cast<std::ptrdiff_t>(3 * triangle); };
    const std::size_t count = bars.bars.size();
    // Bars that move to the front go first to last and bars that move to the back last to first, so that no triangle is
    // overwritten before it has moved.
    for (std::size_t n = 0; n < count; ++n) {
        const Bar& bar = bars.bars[n];
        if (!redrawn[n] && bar.first_triangle < before[n])
            std::copy(at(before[n]), at(before[n] + bar.triangles), at(bar.first_triangle));
    }
    for (std::size_t n = count; n-- > 0;) {
        const Bar& bar = bars.bars[n];
        if (!redrawn[n] && bar.first_triangle > before[n]) {
            std::copy_backward(at(before[n]), at(before[n] + bar.triangles), at(bar.first_triangle + bar.triangles));
        }
    }
    for (std::size_t n = 0; n < count; ++n) {
        if (redrawn[n]) std::copy(redrawn[n]->begin(), redrawn[n]->end(), at(bars.bars[n].first_triangle));
    }
}

}  // namespace isocore::climbing
