// site.hpp - One block, copied close together: its sign bits, its crossed edges, and the numbers of their crossings.
// All places are in samples from the block's origin.
#pragma once

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

// What is known of row (j, k) of a block; bit i of a word is sample i, or the edge that starts there.
struct SiteRow {
    std::uint64_t signs;
    std::array<std::uint64_t, 3> crossed;         // edges along each axis that start in this row
    std::array<std::uint32_t, 3> first_crossing;  // the number of the first crossed one; undefined where there is none
};

class Site {
  public:
    static constexpr std::size_t kRows = 33 * 33;  // of the largest block

    explicit Site(int block_size);

    // Goes to the start of the bar whose first rows are (y, z). Its blocks must then be loaded in their order, as their
    // crossings are counted on the way; only blocks without any crossing may be left out.
    void begin(const SignGrid& signs, const Layout& layout, std::size_t y, std::size_t z);
    // Loads the bar's block that starts at sample x.
    void load(std::size_t x);

    // The rows and axes for which any edge is crossed, each as an edge along that axis at sample 0 of that row.
    std::span<const Edge> crossed_rows() const { return {crossed_rows_.data(), crossed_size_}; }

    const SiteRow& row(int j, int k) const { return rows_[row_index(j, k)]; }

    bool is_crossed(std::size_t axis, const Place& at) const { return row(at[1], at[2]).crossed[axis] >> at[0] & 1; }

    // The number of a crossed edge's crossing: a rank query in its row.
    std::size_t crossing(int axis, const Place& at) const {
        const SiteRow& here = row(at[1], at[2]);
        const auto a = static_cast<std::size_t>(axis);
        return here.first_crossing[a] + ones(here.crossed[a] & ((std::uint64_t{1} << at[0]) - 1));
    }

    std::size_t samples() const { return static_cast<std::size_t>(stride_); }  // of a lign: block size + 1

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

    Dims origin{};                    // the block's first sample
    Place cells{};                    // per axis; fewer than the block size at the volume's end
    std::array<bool, 3> ends_grid{};  // is the block the last one along an axis?

  protected:
    static std::uint32_t ones(std::uint64_t word) { return static_cast<std::uint32_t>(std::popcount(word)); }
    std::size_t row_index(int j, int k) const { return static_cast<std::size_t>(j + stride_ * k); }

    // Calls visit(j, k) for all rows of the block.
    template <class Visit>
    void for_rows(const Visit& visit) {
        for (int k = 0; k <= cells[2]; ++k) {
            for (int j = 0; j <= cells[1]; ++j) visit(j, k);
        }
    }

    const SignGrid* signs_ = nullptr;
    const Layout* layout_ = nullptr;
    // By row, along each axis: the number of the first crossing past the blocks of the bar that were loaded.
    Array<std::array<std::uint32_t, 3>> next_crossings_;

  private:
    SignRow signs_of(int j, int k) const {
        return signs_->row(origin[1] + static_cast<std::size_t>(j), origin[2] + static_cast<std::size_t>(k));
    }
    void set_size(std::size_t axis);
    void find_crossed_rows(std::uint64_t samples);

    int stride_;
    Array<SiteRow> rows_;
    Array<Edge> crossed_rows_;  // with room for one entry more, which is written but does not count
    std::size_t crossed_size_ = 0;
};

}  // namespace isocore::climbing
