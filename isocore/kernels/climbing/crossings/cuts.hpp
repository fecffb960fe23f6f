// cuts.hpp - Where the edges of a block's highrices run: a bit for every grid edge, which is what the layout keeps if
// it is crossed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "climbing/crossings/layout.hpp"
#include "climbing/crossings/site.hpp"
#include "climbing/high_rice.hpp"

namespace isocore::climbing {

template <int N>
class Cuts {
  public:
    void clear() { rows_ = {}; }

    void add(const HighRice& box) {
        const int x0 = box.low[0], x1 = box.high[0], y0 = box.low[1], y1 = box.high[1], z0 = box.low[2],
                  z1 = box.high[2];
        const std::uint64_t along = (std::uint64_t{1} << x1) - (std::uint64_t{1} << x0),
                            ends = std::uint64_t{1} << x0 | std::uint64_t{1} << x1;
        for (const int k : {z0, z1}) {
            for (const int j : {y0, y1}) at(j, k)[0] |= along;
            for (int j = y0; j < y1; ++j) at(j, k)[1] |= ends;
        }
        for (int k = z0; k < z1; ++k) {
            for (const int j : {y0, y1}) at(j, k)[2] |= ends;
        }
    }

    // The single cells of a row.
    void add_cells(int j, int k, std::uint64_t cells) {
        const std::uint64_t ends = cells | cells << 1;
        for (const int up : {0, 1}) {
            for (const int right : {0, 1}) at(j + right, k + up)[0] |= cells;
            at(j, k + up)[1] |= ends;
            at(j + up, k)[2] |= ends;
        }
    }

    void keep(const Site& site, Layout& layout) const {
        struct Part {
            std::uint64_t crossed, cut;
            std::size_t first;
        };
        std::array<Part, 3 * (N + 1) * (N + 1) + 1>
            parts;  // those where anything is to be kept, found without a branch for each
        Part* end = parts.data();
        for (const Edge& start : site.crossed_rows()) {
            const int j = start.at(1), k = start.at(2);
            const Site::Row& row = site.row(j, k);
            *end = {row.crossed[start.axis()], rows_[index(j, k)][start.axis()], row.first_crossing[start.axis()]};
            end += (end->crossed & end->cut) != 0;
        }
        for (const Part* part = parts.data(); part != end; ++part) layout.keep(part->crossed, part->cut, part->first);
    }

  private:
    static std::size_t index(int j, int k) { return static_cast<std::size_t>(j + (N + 1) * k); }
    std::array<std::uint64_t, 3>& at(int j, int k) { return rows_[index(j, k)]; }

    std::array<std::array<std::uint64_t, 3>, (N + 1) * (N + 1)>
        rows_;  // edges along each axis that start in row (j, k)
};

}  // namespace isocore::climbing
