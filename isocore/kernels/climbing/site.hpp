// site.hpp - One block with its neighbours' cuts, copied close together for drawing: sign bits, kept edges, and the
// vertex numbers its rows begin with. All places are in samples from the block's origin.
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
    explicit Site(int block_size) : stride_(block_size + 1) {}

    void load(const SignGrid& signs, const Layout& layout, const Dims& at) {
        origin = at;
        for (std::size_t a = 0; a < 3; ++a) {
            cells[a] = static_cast<int>(std::min<std::size_t>(static_cast<std::size_t>(stride_ - 1), signs.dims[a] - 1 - at[a]));
            ends_grid[a] = at[a] + static_cast<std::size_t>(cells[a]) + 1 == signs.dims[a];
        }
        const std::size_t w = at[0] / 64, shift = at[0] % 64;
        const bool two_words = shift + static_cast<std::size_t>(cells[0]) >= 64;
        const std::uint64_t samples = (std::uint64_t{2} << cells[0]) - 1;
        const auto cut = [&](const std::uint64_t* row) { return (row[w] >> shift | (two_words ? row[w + 1] << 1 << (63 - shift) : 0)) & samples; };
        for (int k = 0; k <= cells[2]; ++k) {
            for (int j = 0; j <= cells[1]; ++j) {
                const std::size_t gj = at[1] + static_cast<std::size_t>(j), gk = at[2] + static_cast<std::size_t>(k);
                Row& row = rows_[row_index(j, k)];
                row.signs = cut(signs.row(gj, gk));
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    const std::uint64_t* kept = layout.row(axis, gj, gk);
                    row.kept[axis] = cut(kept);
                    std::uint32_t first = layout.base(gj, gk)[axis] + ones(kept[w] & ((std::uint64_t{1} << shift) - 1));
                    for (std::size_t n = 0; n < w; ++n) first += ones(kept[n]);
                    row.first[axis] = first;
                }
            }
        }
    }

    bool sign(const Place& at) const { return row(at[1], at[2]).signs >> at[0] & 1; }
    bool kept(int axis, const Place& at) const { return row(at[1], at[2]).kept[static_cast<std::size_t>(axis)] >> at[0] & 1; }
    std::uint64_t signs(int j, int k) const { return row(j, k).signs; }
    std::uint64_t kept(int axis, int j, int k) const { return row(j, k).kept[static_cast<std::size_t>(axis)]; }

    // The vertex number of a kept edge.
    std::int32_t vertex(int axis, const Place& at) const {
        const Row& here = row(at[1], at[2]);
        const auto a = static_cast<std::size_t>(axis);
        return static_cast<std::int32_t>(here.first[a] + ones(here.kept[a] & ((std::uint64_t{1} << at[0]) - 1)));
    }

    // Crossed edges along an axis that start in row (j, k) of the block.
    std::uint64_t crossed(int axis, int j, int k) const {
        const std::uint64_t here = signs(j, k);
        if (axis == 0) return (here ^ here >> 1) & ((std::uint64_t{1} << cells[0]) - 1);
        return here ^ (axis == 1 ? signs(j + 1, k) : signs(j, k + 1));
    }

    // The eight corner signs of a box, numbered as in cube.hpp.
    unsigned corners(const HighRice& box) const {
        unsigned out = 0, place = 0;
        for (const int k : {box.low[2], box.high[2]}) {
            for (const int j : {box.low[1], box.high[1]}) {
                const std::uint64_t bits = signs(j, k);
                out |= static_cast<unsigned>((bits >> box.low[0] & 1) | (bits >> box.high[0] & 1) << 1) << place;
                place += 2;
            }
        }
        return out;
    }

    Dims origin{};
    Place cells{};                        // per axis; fewer than the block size at the volume's end
    std::array<bool, 3> ends_grid{};      // is the block the last one along an axis?

  private:
    struct Row {
        std::uint64_t signs;
        std::array<std::uint64_t, 3> kept;
        std::array<std::uint32_t, 3> first;
    };

    static std::uint32_t ones(std::uint64_t word) { return static_cast<std::uint32_t>(std::popcount(word)); }
    std::size_t row_index(int j, int k) const { return static_cast<std::size_t>(j + stride_ * k); }
    const Row& row(int j, int k) const { return rows_[row_index(j, k)]; }

    int stride_;
    std::array<Row, 33 * 33> rows_;
};

}  // namespace isocore::climbing
