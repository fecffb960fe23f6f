// site.hpp - One block with its neighbours' cuts, copied close together: sign bits, kept edges, and the numbers that
// crossings and vertices of its rows begin with. All places are in samples from the block's origin.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "climbing/high_rice.hpp"
#include "climbing/layout.hpp"
#include "common/cube.hpp"
#include "common/signs.hpp"

namespace isocore::climbing {

using Place = std::array<int, 3>;

class Site {
  public:
    struct Row {
        std::uint64_t signs;
        std::array<std::uint64_t, 3> crossed, kept;  // edges along each axis that start in this row
        std::array<std::uint32_t, 3> first_crossing, first_vertex;  // the numbers of the first among them
    };

    explicit Site(int block_size) : stride_(block_size + 1) {}

    // Goes to the start of the bar through (y, z). Its blocks are then loaded in their order; only those without any
    // crossing may be left out.
    void begin(const SignGrid& signs, const Layout& layout, std::size_t y, std::size_t z) {
        signs_ = &signs;
        layout_ = &layout;
        origin = {0, y, z};
        for (std::size_t a = 1; a < 3; ++a) set_size(a);
        for_rows([&](int j, int k) {
            const auto [gj, gk] = in_grid(j, k);
            const auto counts = count_crossings(signs, gj, gk);
            const std::uint32_t first = layout.first_crossing(gj, gk);
            next_[row_index(j, k)].crossings = {first, first + counts[0], first + counts[0] + counts[1]};
        });
    }
    // The same, once it is known what is kept.
    void begin_with_vertices(const SignGrid& signs, const Layout& layout, std::size_t y, std::size_t z) {
        begin(signs, layout, y, z);
        for_rows([&](int j, int k) {
            const auto [gj, gk] = in_grid(j, k);
            Next& next = next_[row_index(j, k)];
            for (std::size_t axis = 0; axis < 3; ++axis) next.vertices[axis] = static_cast<std::uint32_t>(layout.vertex(next.crossings[axis], gj, gk));
        });
    }

    void load(std::size_t x) {
        origin[0] = x;
        set_size(0);
        for_rows([&](int j, int k) { load_row(j, k); });
    }

    void load_with_vertices(std::size_t x) {
        load(x);
        lay_columns();
        for (auto& axis : kept_columns_) std::fill_n(axis.begin(), stride_ * stride_, 0);
        for_rows([&](int j, int k) { load_kept(j, k); });
    }

    // Makes lign() ready for axes other than the first.
    void lay_columns() {
        for (auto& axis : sign_columns_) std::fill_n(axis.begin(), stride_ * stride_, 0);
        const auto width = static_cast<std::uint64_t>(stride_);
        const auto spread = [width](std::uint64_t* line, std::uint64_t signs, int bit) {
            for (std::uint64_t i = 0; i < width; ++i) line[i] |= (signs >> i & 1) << bit;
        };
        for_rows([&](int j, int k) {
            const std::uint64_t signs = row(j, k).signs;
            spread(sign_columns_[0].data() + row_index(0, k), signs, j);
            spread(sign_columns_[1].data() + row_index(0, j), signs, k);
        });
    }

    const Row& row(int j, int k) const { return rows_[row_index(j, k)]; }

    // The numbers of a crossed and of a kept edge.
    std::size_t crossing(int axis, const Place& at) const {
        const Row& here = row(at[1], at[2]);
        const auto a = static_cast<std::size_t>(axis);
        return here.first_crossing[a] + ones(here.crossed[a] & ((std::uint64_t{1} << at[0]) - 1));
    }
    std::int32_t vertex(int axis, const Place& at) const {
        const Row& here = row(at[1], at[2]);
        const auto a = static_cast<std::size_t>(axis);
        return static_cast<std::int32_t>(here.first_vertex[a] + ones(here.kept[a] & ((std::uint64_t{1} << at[0]) - 1)));
    }

    // The signs along the lign through a place, one bit per sample.
    std::uint64_t lign(int axis, const Place& at) const {
        if (axis == 0) return row(at[1], at[2]).signs;
        return axis == 1 ? sign_columns_[0][row_index(at[0], at[2])] : sign_columns_[1][row_index(at[0], at[1])];
    }

    // Kept edges along `axis` of line n of the plane across `normal` at `fixed`: lines run along its lower axis.
    std::uint64_t kept_on_plane(int normal, int fixed, int axis, int n) const {
        if (normal == 0) return kept_columns_[static_cast<std::size_t>(axis) - 1][row_index(fixed, n)];
        return (normal == 1 ? row(fixed, n) : row(n, fixed)).kept[static_cast<std::size_t>(axis)];
    }

    // The eight corner signs of a box, numbered as in cube.hpp.
    unsigned corners(const HighRice& box) const {
        unsigned out = 0, place = 0;
        for (const int k : {box.low[2], box.high[2]}) {
            for (const int j : {box.low[1], box.high[1]}) {
                const std::uint64_t bits = row(j, k).signs;
                out |= static_cast<unsigned>((bits >> box.low[0] & 1) | (bits >> box.high[0] & 1) << 1) << place;
                place += 2;
            }
        }
        return out;
    }

    Dims origin{};
    Place cells{};                    // per axis; fewer than the block size at the volume's end
    std::array<bool, 3> ends_grid{};  // is the block the last one along an axis?

  private:
    static std::uint32_t ones(std::uint64_t word) { return static_cast<std::uint32_t>(std::popcount(word)); }
    std::size_t row_index(int j, int k) const { return static_cast<std::size_t>(j + stride_ * k); }

    template <class Visit>
    void for_rows(const Visit& visit) {
        for (int k = 0; k <= cells[2]; ++k) {
            for (int j = 0; j <= cells[1]; ++j) visit(j, k);
        }
    }
    std::array<std::size_t, 2> in_grid(int j, int k) const { return {origin[1] + static_cast<std::size_t>(j), origin[2] + static_cast<std::size_t>(k)}; }
    void set_size(std::size_t axis) {
        const std::size_t left = signs_->dims[axis] - 1 - origin[axis];
        cells[axis] = static_cast<int>(std::min<std::size_t>(static_cast<std::size_t>(stride_ - 1), left));
        ends_grid[axis] = static_cast<std::size_t>(cells[axis]) == left;
    }

    void load_row(int j, int k) {
        Row& out = rows_[row_index(j, k)];
        const auto [gj, gk] = in_grid(j, k);
        const std::size_t w = origin[0] / 64, shift = origin[0] % 64;
        const bool two_words = shift + static_cast<std::size_t>(cells[0]) >= 64;
        const std::uint64_t samples = (std::uint64_t{2} << cells[0]) - 1, own = ends_grid[0] ? samples : samples >> 1;
        const auto cut = [&](const std::uint64_t* row) { return (row[w] >> shift | (two_words ? row[w + 1] << 1 << (63 - shift) : 0)) & samples; };
        out.signs = cut(signs_->row(gj, gk));
        out.crossed[0] = (out.signs ^ out.signs >> 1) & samples >> 1;
        out.crossed[1] = j < cells[1] ? out.signs ^ cut(signs_->row(gj + 1, gk)) : 0;
        out.crossed[2] = k < cells[2] ? out.signs ^ cut(signs_->row(gj, gk + 1)) : 0;
        Next& next = next_[row_index(j, k)];
        for (std::size_t axis = 0; axis < 3; ++axis) {
            out.first_crossing[axis] = next.crossings[axis];
            next.crossings[axis] += ones(out.crossed[axis] & own);
        }
    }

    void load_kept(int j, int k) {
        Row& out = rows_[row_index(j, k)];
        Next& next = next_[row_index(j, k)];
        const std::uint64_t own = ends_grid[0] ? ~std::uint64_t{0} : (std::uint64_t{1} << cells[0]) - 1;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            out.kept[axis] = layout_->kept(out.crossed[axis], out.first_crossing[axis]);
            out.first_vertex[axis] = next.vertices[axis];
            next.vertices[axis] += ones(out.kept[axis] & own);
            if (axis == 0) continue;
            for (std::uint64_t left = out.kept[axis]; left; left &= left - 1) {
                kept_columns_[axis - 1][row_index(std::countr_zero(left), k)] |= std::uint64_t{1} << j;
            }
        }
    }

    // What comes after the blocks that were loaded.
    struct Next {
        std::array<std::uint32_t, 3> crossings, vertices;
    };
    using Plane = std::array<std::uint64_t, 33 * 33>;

    const SignGrid* signs_ = nullptr;
    const Layout* layout_ = nullptr;
    int stride_;
    std::array<Row, 33 * 33> rows_;
    std::array<Next, 33 * 33> next_;
    std::array<Plane, 2> sign_columns_;  // along y: [k][i], bit j; along z: [j][i], bit k
    std::array<Plane, 2> kept_columns_;  // kept edges along y and z: [k][i], bit j
};

}  // namespace isocore::climbing
