// drawn_site.hpp - A site once it is known which crossings are vertices, of its own boxes or of its neighbours'.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "climbing/crossings/site.hpp"

namespace isocore::climbing {

class DrawnSite : public Site {
  public:
    // Edges that start in half a row, at samples 0 ... 20 or 16 ... 36, side by side: those along x, along y, along z.
    // A box lies in either half of a row, unless it is longer than a half.
    using Half = std::uint64_t;
    static constexpr int kWindow = 21, kHalf = 16;

    // What becomes of the crossed edges that start in a row.
    struct Cut {
        std::array<std::uint64_t, 3> kept{};          // along each axis
        std::array<std::uint32_t, 3> first_vertex{};  // the numbers of the first of them, where there are any
        std::array<Half, 2> kept_halves{}, dropped_halves{};
    };

    explicit DrawnSite(int block_size) : Site(block_size) {
        cuts_.resize(samples() * samples());
        next_vertices_.resize(cuts_.size());
    }

    void begin(const SignGrid& signs, const Layout& layout, std::size_t y, std::size_t z) {
        Site::begin(signs, layout, y, z);
        for_rows([&](int j, int k) {
            const std::size_t row = row_index(j, k);
            for (std::size_t axis = 0; axis < 3; ++axis)
                next_vertices_[row][axis] = static_cast<std::uint32_t>(layout.vertex(next_crossings_[row][axis]));
        });
    }

    void load(std::size_t x) {
        Site::load(x);
        std::fill(cuts_.begin(), cuts_.end(), Cut{});
        const std::uint64_t own = ends_grid[0] ? ~std::uint64_t{0} : (std::uint64_t{1} << cells[0]) - 1;
        for (const Edge& start : crossed_rows()) {
            const std::size_t row = row_index(start.at(1), start.at(2)), axis = start.axis();
            const Row& here = this->row(start.at(1), start.at(2));
            const std::uint64_t crossed = here.crossed[axis], kept = layout_->kept(crossed, here.first_crossing[axis]);
            Cut& out = cuts_[row];
            out.kept[axis] = kept;
            out.first_vertex[axis] = next_vertices_[row][axis];
            next_vertices_[row][axis] += ones(kept & own);
            for (std::size_t half = 0; half <= static_cast<std::size_t>(cells[0] > kHalf); ++half) {
                const auto window = [&](std::uint64_t edges) {
                    return (edges >> kHalf * half & ((Half{1} << kWindow) - 1)) << kWindow * axis;
                };
                out.kept_halves[half] |= window(kept);
                out.dropped_halves[half] |= window(crossed ^ kept);
            }
        }
    }

    const Cut& cut(int j, int k) const { return cuts_[row_index(j, k)]; }

    // The number of a kept edge.
    std::int32_t vertex(std::size_t axis, const Place& at) const {
        const Cut& here = cut(at[1], at[2]);
        return static_cast<std::int32_t>(here.first_vertex[axis] +
                                         ones(here.kept[axis] & ((std::uint64_t{1} << at[0]) - 1)));
    }

  private:
    Array<Cut> cuts_;
    Array<std::array<std::uint32_t, 3>> next_vertices_;  // what comes after the blocks that were loaded
};

}  // namespace isocore::climbing
