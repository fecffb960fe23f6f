#include "simplification/reference.hpp"

#include <algorithm>
#include <limits>

namespace isocore::simplification {

template <class Real>
Reference<Real>::Reference(const MeshArrays<Real>& mesh, const Cells& cells)
    : mesh_(mesh), cells_(cells), index_(index_of(mesh, cells)) {
    find_border();
}

// In each cell that a triangle's box touches; a box that ends where a cell begins does not touch that. A triangle of
// marching cubes has one cell.
template <class Real>
CellIndex Reference<Real>::index_of(const MeshArrays<Real>& mesh, const Cells& cells) {
    const auto each_entry = [&](const auto& visit) {
        for (std::size_t t = 0; t < mesh.triangle_count; ++t) {
            const auto corner = [&](std::size_t n) {
                return mesh.vertices + 3 * static_cast<std::size_t>(mesh.triangles[3 * t + n]);
            };
            const Real *const one = corner(0), *const two = corner(1), *const three = corner(2);
            Cell low, high;
            for (std::size_t a = 0; a < 3; ++a) {
                const auto in_cells = [&](Real at) { return cells.in_cells(static_cast<double>(at), a); };
                const double least = in_cells(std::min({one[a], two[a], three[a]}));
                const double most = in_cells(std::max({one[a], two[a], three[a]}));
                low[a] = cells.clamped(least, a);
                high[a] = cells.clamped(most, a);
                if (high[a] > low[a] && static_cast<double>(high[a]) == most) --high[a];
            }
            each_cell_between(low, high,
                              [&](const Cell& cell) { visit(static_cast<std::int32_t>(t), cells.number(cell)); });
        }
    };
    return CellIndex(cells.dims, mesh.triangle_count, each_entry);
}

// Around a vertex inside the surface, each neighbour is the end of one opposite side and the start of another; at the
// border, and where more than two triangles share a side, some are not. Numbers are scattered before they are added up,
// so that no sum is 0 by chance.
template <class Real>
void Reference<Real>::find_border() {
    const auto scattered = [](std::int32_t vertex) {
        auto n = static_cast<std::uint32_t>(vertex) * 0x9e3779b1u;
        n = (n ^ n >> 15) * 0x85ebca77u;
        return n ^ n >> 13;
    };
    std::vector<std::uint32_t> sums(mesh_.vertex_count);
    for (std::size_t t = 0; t < mesh_.triangle_count; ++t) {
        const std::int32_t* c = mesh_.triangles + 3 * t;
        for (std::size_t n = 0; n < 3; ++n)
            sums[static_cast<std::size_t>(c[n])] += scattered(c[(n + 1) % 3]) - scattered(c[(n + 2) % 3]);
    }
    at_border_.resize(mesh_.vertex_count);
    std::transform(sums.begin(), sums.end(), at_border_.begin(), [](std::uint32_t sum) { return sum != 0; });
    if (mesh_.sheets != nullptr) find_curves();
    has_border_ = std::find(at_border_.begin(), at_border_.end(), 1) != at_border_.end();
}

// Where sheets meet, each of them ends.
template <class Real>
void Reference<Real>::find_curves() {
    std::vector<std::uint32_t> sheet_at(mesh_.vertex_count, std::numeric_limits<std::uint32_t>::max());
    for (std::size_t n = 0; n < 3 * mesh_.triangle_count; ++n) {
        const auto v = static_cast<std::size_t>(mesh_.triangles[n]);
        const std::uint32_t sheet = (*mesh_.sheets)[n / 3];
        if (sheet_at[v] == std::numeric_limits<std::uint32_t>::max()) sheet_at[v] = sheet;
        if (sheet_at[v] != sheet) at_border_[v] = 1;
    }
}

template class Reference<float>;
template class Reference<double>;

}  // namespace isocore::simplification
