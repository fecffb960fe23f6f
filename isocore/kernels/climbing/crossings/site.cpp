#include "climbing/crossings/site.hpp"

#include <algorithm>

#include "samples/crossed_edges.hpp"

namespace isocore::climbing {

Site::Site(int block_size) : stride_(block_size + 1) {
    const std::size_t rows = samples() * samples();
    next_crossings_.resize(rows);
    rows_.resize(rows);
    crossed_rows_.resize(3 * rows + 1);
}

void Site::begin(const SignGrid& signs, const Layout& layout, std::size_t y, std::size_t z) {
    signs_ = &signs;
    layout_ = &layout;
    origin = {0, y, z};
    for (std::size_t a = 1; a < 3; ++a) set_size(a);
    std::uint32_t crossing = 0;
    for_rows([&](int j, int k) {
        const std::size_t grid_j = y + static_cast<std::size_t>(j), grid_k = z + static_cast<std::size_t>(k);
        if (j == 0) crossing = layout.first_crossing(grid_j, grid_k);
        const auto counts = count_crossings(signs, grid_j, grid_k);
        next_crossings_[row_index(j, k)] = {crossing, crossing + counts[0], crossing + counts[0] + counts[1]};
        crossing += counts[0] + counts[1] + counts[2];
    });
}

void Site::load(std::size_t x) {
    origin[0] = x;
    set_size(0);
    // Edges that start in the block's last sample are the next block's own, if there is one.
    const std::uint64_t samples = (std::uint64_t{2} << cells[0]) - 1, own = ends_grid[0] ? samples : samples >> 1;
    for_rows([&](int j, int k) { rows_[row_index(j, k)].signs = signs_of(j, k).from(x) & samples; });
    find_crossed_rows(samples);
    for (const Edge& start : crossed_rows()) {
        const std::size_t row = row_index(start.at(1), start.at(2)), axis = start.axis();
        rows_[row].first_crossing[axis] = next_crossings_[row][axis];
        next_crossings_[row][axis] += ones(rows_[row].crossed[axis] & own);
    }
}

// Sets `cells` and `ends_grid` of an axis.
void Site::set_size(std::size_t axis) {
    const std::size_t left = signs_->dims[axis] - 1 - origin[axis];
    cells[axis] = static_cast<int>(std::min<std::size_t>(static_cast<std::size_t>(stride_ - 1), left));
    ends_grid[axis] = static_cast<std::size_t>(cells[axis]) == left;
}

// Finds the crossed edges of all rows from their signs. A row's entry is always written to the end of crossed_rows_;
// the end moves on only if an edge is crossed, so that no branch can be mispredicted.
void Site::find_crossed_rows(std::uint64_t samples) {
    Edge* end = crossed_rows_.data();
    for_rows([&](int j, int k) {
        SiteRow* const row = rows_.data() + row_index(j, k);
        const SiteRow &right = row[j < cells[1] ? 1 : 0], &up = row[k < cells[2] ? stride_ : 0];
        row->crossed = {(row->signs ^ row->signs >> 1) & samples >> 1, row->signs ^ right.signs, row->signs ^ up.signs};
        const Edge start = Edge::along_x(0, static_cast<unsigned>(j), static_cast<unsigned>(k));
        for (int axis = 0; axis < 3; ++axis) {
            *end = start.of_axis(axis);
            end += row->crossed[static_cast<std::size_t>(axis)] != 0;
        }
    });
    crossed_size_ = static_cast<std::size_t>(end - crossed_rows_.data());
}

}  // namespace isocore::climbing
