// site.hpp - One block, copied close together: its sign bits, its crossed edges, and the numbers of their crossings.
// All places are in samples from the block's origin.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "climbing/crossings/layout.hpp"
#include "climbing/high_rice.hpp"
#include "common/array.hpp"
#include "samples/edge.hpp"
#include "samples/signs.hpp"

namespace isocore::climbing {

class Site {
  public:
    static constexpr std::size_t kRows = 33 * 33;  // of the largest block

    struct Row {
        std::uint64_t signs;
        std::array<std::uint64_t, 3> crossed;         // edges along each axis that start in this row
        std::array<std::uint32_t, 3> first_crossing;  // the numbers of the first among them, where there are any
    };

    explicit Site(int block_size) : stride_(block_size + 1) {
        const std::size_t rows = samples() * samples();
        next_crossings_.resize(rows);
        rows_.resize(rows);
        crossed_rows_.resize(3 * rows + 1);
    }

    // Goes to the start of the bar through (y, z). Its blocks are then loaded in their order; only those without any
    // crossing may be left out.
    void begin(const SignGrid& signs, const Layout& layout, std::size_t y, std::size_t z) {
        signs_ = &signs;
        layout_ = &layout;
        origin = {0, y, z};
        for (std::size_t a = 1; a < 3; ++a) set_size(a);
        std::uint32_t crossing = 0;
        for_rows([&](int j, int k) {
            const auto [gj, gk] = in_grid(j, k);
            if (j == 0) crossing = layout.first_crossing(gj, gk);
            const auto counts = count_crossings(signs, gj, gk);
            next_crossings_[row_index(j, k)] = {crossing, crossing + counts[0], crossing + counts[0] + counts[1]};
            crossing += counts[0] + counts[1] + counts[2];
        });
    }

    void load(std::size_t x) {
        origin[0] = x;
        set_size(0);
        const std::uint64_t samples = (std::uint64_t{2} << cells[0]) - 1, own = ends_grid[0] ? samples : samples >> 1;
        for_rows([&](int j, int k) {
            const auto [gj, gk] = in_grid(j, k);
            rows_[row_index(j, k)].signs = signs_->row(gj, gk).from(x) & samples;
        });
        find_crossed_rows(samples);
        for (const Edge& start : crossed_rows()) {
            const std::size_t row = row_index(start.at(1), start.at(2)), axis = start.axis();
            rows_[row].first_crossing[axis] = next_crossings_[row][axis];
            next_crossings_[row][axis] += ones(rows_[row].crossed[axis] & own);
        }
    }

    // The rows in which any edges along an axis are crossed, as the first of those edges.
    std::span<const Edge> crossed_rows() const { return {crossed_rows_.data(), crossed_size_}; }

    const Row& row(int j, int k) const { return rows_[row_index(j, k)]; }

    bool is_crossed(std::size_t axis, const Place& at) const { return row(at[1], at[2]).crossed[axis] >> at[0] & 1; }

    // The number of a crossed edge.
    std::size_t crossing(int axis, const Place& at) const {
        const Row& here = row(at[1], at[2]);
        const auto a = static_cast<std::size_t>(axis);
        return here.first_crossing[a] + ones(here.crossed[a] & ((std::uint64_t{1} << at[0]) - 1));
    }

    std::size_t samples() const { return static_cast<std::size_t>(stride_); }  // of a lign

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

  protected:
    static std::uint32_t ones(std::uint64_t word) { return static_cast<std::uint32_t>(std::popcount(word)); }
    std::size_t row_index(int j, int k) const { return static_cast<std::size_t>(j + stride_ * k); }

    template <class Visit>
    void for_rows(const Visit& visit) {
        for (int k = 0; k <= cells[2]; ++k) {
            for (int j = 0; j <= cells[1]; ++j) visit(j, k);
        }
    }
    std::array<std::size_t, 2> in_grid(int j, int k) const {
        return {origin[1] + static_cast<std::size_t>(j), origin[2] + static_cast<std::size_t>(k)};
    }

    const SignGrid* signs_ = nullptr;
    const Layout* layout_ = nullptr;
    Array<std::array<std::uint32_t, 3>> next_crossings_;  // of each row: what comes after the blocks that were loaded

  private:
    void set_size(std::size_t axis) {
        const std::size_t left = signs_->dims[axis] - 1 - origin[axis];
        cells[axis] = static_cast<int>(std::min<std::size_t>(static_cast<std::size_t>(stride_ - 1), left));
        ends_grid[axis] = static_cast<std::size_t>(cells[axis]) == left;
    }

    void find_crossed_rows(std::uint64_t samples) {
        Edge* end = crossed_rows_.data();
        for_rows([&](int j, int k) {
            Row* const row = rows_.data() + row_index(j, k);
            const Row &right = row[j < cells[1] ? 1 : 0], &up = row[k < cells[2] ? stride_ : 0];
            row->crossed = {(row->signs ^ row->signs >> 1) & samples >> 1, row->signs ^ right.signs,
                            row->signs ^ up.signs};
            const Edge start = Edge::along_x(0, static_cast<unsigned>(j), static_cast<unsigned>(k));
            for (int axis = 0; axis < 3; ++axis) {
                *end = start.of_axis(axis);
                end += row->crossed[static_cast<std::size_t>(axis)] != 0;
            }
        });
        crossed_size_ = static_cast<std::size_t>(end - crossed_rows_.data());
    }

    int stride_;
    Array<Row> rows_;
    Array<Edge> crossed_rows_;  // and room for one that is not
    std::size_t crossed_size_ = 0;
};

}  // namespace isocore::climbing
