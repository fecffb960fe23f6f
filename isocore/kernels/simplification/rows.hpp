// rows.hpp - The reference's triangles in and around a box, copied coordinate by coordinate, so that those that follow
// each other are read eight at once. Rows of cells are copied when they are first asked for.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/array.hpp"
#include "simplification/cells.hpp"
#include "simplification/reference.hpp"

namespace isocore::simplification {

class Rows {
  public:
    // x, y and z of three corners; then whether a side may be on the reference's border, 1 or 0.
    static constexpr std::size_t kBorder = 9, kColumns = 10;
    static constexpr std::int32_t kMostCells = 63;  // of a row

    // From now on, what is in these cells, both included, may be asked for.
    void cover(const Cell& low, const Cell& high);
    void forget() { cover({0, 0, 0}, {-1, -1, -1}); }
    bool cover_all(const Cell& low, const Cell& high) const;
    // visit(first, count) of each run of triangles in the cells from `low` to `high`, both included, which are covered:
    // where in the columns it begins, and how many there are. Reading may go on past the last by one register of lanes.
    template <class Visit>
    void each_run_between(const Reference<float>& reference, const Cell& low, const Cell& high, const Visit& visit) {
        const auto before = [&](std::int32_t i) { return (std::uint64_t{1} << (i - low_[0])) - 1; };
        const std::uint64_t left = before(low[0]), right = before(high[0] + 1), between = right & ~left;
        for (std::int32_t k = low[2]; k <= high[2]; ++k) {
            for (std::int32_t j = low[1]; j <= high[1]; ++j) {
                const Row& row = row_of(reference, j, k);
                if ((row.occupied & between) == 0) continue;
                const std::uint32_t* const starts = starts_.data() + row.starts;
                const std::uint32_t first = starts[std::popcount(row.occupied & left)];
                visit(first, starts[std::popcount(row.occupied & right)] - first);
            }
        }
    }
    // The numbers of eight triangles, column by column, from a multiple of eight on.
    const float* eight(std::size_t first) const { return numbers_.data() + first * kColumns; }

  private:
    struct Row {
        std::uint64_t occupied;  // a bit for each cell, and one that is set where the row is not copied yet
        std::size_t starts;      // in starts_: of each occupied cell in the columns, and of what follows
    };
    static constexpr std::uint64_t kUnknown = std::uint64_t{1} << kMostCells;

    const Row& row_of(const Reference<float>& reference, std::int32_t j, std::int32_t k) {
        Row& row = rows_[static_cast<std::size_t>((k - low_[2]) * (high_[1] - low_[1] + 1) + j - low_[1])];
        if (row.occupied & kUnknown) copy(reference, j, k, row);
        return row;
    }
    void copy(const Reference<float>& reference, std::int32_t j, std::int32_t k, Row& row);
    void make_room(const Reference<float>& reference);

    Cell low_{0, 0, 0}, high_{-1, -1, -1};
    std::vector<Row> rows_;
    std::vector<std::uint32_t> starts_;
    Array<float> numbers_;
    std::size_t size_ = 0;
};

}  // namespace isocore::simplification
