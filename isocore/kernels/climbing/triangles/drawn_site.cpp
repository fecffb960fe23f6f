#include "climbing/triangles/drawn_site.hpp"

#include <algorithm>

namespace isocore::climbing {

DrawnSite::DrawnSite(int block_size) : Site(block_size) {
    kept_rows_.resize(samples() * samples());
    next_vertices_.resize(kept_rows_.size());
}

void DrawnSite::begin(const SignGrid& signs, const Layout& layout, std::size_t y, std::size_t z) {
    Site::begin(signs, layout, y, z);
    for_rows([&](int j, int k) {
        const std::size_t row = row_index(j, k);
        for (std::size_t axis = 0; axis < 3; ++axis)
            next_vertices_[row][axis] = static_cast<std::uint32_t>(layout.vertex(next_crossings_[row][axis]));
    });
}

void DrawnSite::load(std::size_t x) {
    Site::load(x);
    std::fill(kept_rows_.begin(), kept_rows_.end(), KeptRow{});
    // Edges in the block's last plane of samples across x are the next block's first, and are counted there.
    const std::uint64_t own = ends_grid[0] ? ~std::uint64_t{0} : (std::uint64_t{1} << cells[0]) - 1;
    for (const Edge& start : crossed_rows()) {
        const std::size_t row = row_index(start.at(1), start.at(2)), axis = start.axis();
        const auto& here = this->row(start.at(1), start.at(2));
        const std::uint64_t crossed = here.crossed[axis], kept = layout_->kept(crossed, here.first_crossing[axis]);
        KeptRow& out = kept_rows_[row];
        out.kept[axis] = kept;
        out.first_vertex[axis] = next_vertices_[row][axis];
        next_vertices_[row][axis] += ones(kept & own);
        for (std::size_t n = 0; n <= static_cast<std::size_t>(cells[0] > kWindowStep); ++n) {
            const auto window = [&](std::uint64_t edges) {
                return (edges >> kWindowStep * n & ((Window{1} << kWindowSamples) - 1)) << kWindowSamples * axis;
            };
            out.kept_windows[n] |= window(kept);
            out.dropped_windows[n] |= window(crossed ^ kept);
        }
    }
}

}  // namespace isocore::climbing
