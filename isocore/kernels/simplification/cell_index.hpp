// cell_index.hpp - Triangles found by the cells that they are entered in. Triangles of one cell follow each other, and
// so do cells of one row, so that a piece of a row is one run of triangles.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "common/array.hpp"
#include "simplification/cells.hpp"

namespace isocore::simplification {

class CellIndex {
  public:
    // each_entry(visit) calls visit(triangle, number of a cell) for each cell of each of so many triangles, in
    // ascending order of these; up to three times the same. dims: how many cells there are along each axis.
    template <class EachEntry>
    CellIndex(const std::array<std::size_t, 3>& dims, std::size_t triangles, const EachEntry& each_entry);

    // visit(first, end) of each run of entries in the cells from `low` to `high`, both included. A triangle that lies
    // in several cells may have several entries there.
    template <class Visit>
    void each_run_between(const Cell& low, const Cell& high, const Visit& visit) const {
        for (std::int32_t k = low[2]; k <= high[2]; ++k) {
            for (std::int32_t j = low[1]; j <= high[1]; ++j) {
                const std::uint32_t first = first_of(number_of({low[0], j, k}, dims_));
                const std::uint32_t end = first_of(number_of({high[0], j, k}, dims_) + 1);
                if (first < end) visit(first, end);
            }
        }
    }
    // Which of up to 63 cells of a row from `cell` on have entries, a bit for each; where those of each such cell
    // start; and, one further, where they end.
    struct Occupied {
        std::uint64_t bits;
        const std::uint32_t* starts;
    };
    Occupied occupied(const Cell& cell, std::int32_t count) const {
        const std::size_t first = number_of(cell, dims_), shift = first % 64;
        std::uint64_t bits = occupied_[first / 64] >> shift;
        if (shift > 0) bits |= occupied_[first / 64 + 1] << (64 - shift);
        return {bits & ((std::uint64_t{1} << count) - 1), starts_.data() + rank_of(first)};
    }
    bool is_one_cell() const { return dims_[0] * dims_[1] * dims_[2] == 1; }
    // May a triangle have several entries?
    bool repeats() const { return repeats_; }
    // Is entry n triangle n?
    bool is_in_order() const { return entries_.empty(); }
    // The triangle of an entry.
    std::int32_t entry(std::uint32_t number) const {
        return entries_.empty() ? static_cast<std::int32_t>(number) : entries_[number];
    }

  private:
    // How many occupied cells come before this one.
    std::uint32_t rank_of(std::size_t cell) const {
        const std::uint64_t below = occupied_[cell / 64] & ((std::uint64_t{1} << cell % 64) - 1);
        return ranks_[cell / 64] + static_cast<std::uint32_t>(std::popcount(below));
    }
    // The first entry of this cell or of a later one.
    std::uint32_t first_of(std::size_t cell) const { return starts_[rank_of(cell)]; }

    std::array<std::size_t, 3> dims_;
    bool repeats_ = false;
    Array<std::uint64_t> occupied_;  // a bit for each cell
    Array<std::uint32_t> ranks_;     // of each word: how many bits are set before it
    Array<std::uint32_t> starts_;    // of each occupied cell: its first entry
    Array<std::int32_t> entries_;    // triangles; empty where entry n is triangle n
};

template <class EachEntry>
CellIndex::CellIndex(const std::array<std::size_t, 3>& dims, std::size_t triangles, const EachEntry& each_entry)
    : dims_(dims) {
    const std::size_t words = dims[0] * dims[1] * dims[2] / 64 + 2;
    occupied_.assign(words, 0);
    starts_.reserve(triangles + 1);  // room that stays empty takes no memory
    bool in_order = true;
    std::size_t entries = 0, last = 0;
    each_entry([&](std::int32_t, std::size_t cell) {
        occupied_[cell / 64] |= std::uint64_t{1} << cell % 64;
        in_order = in_order && cell >= last;
        if (in_order && (entries == 0 || cell > last)) starts_.push_back(static_cast<std::uint32_t>(entries));
        last = cell;
        ++entries;
    });
    ranks_.resize(words);
    std::uint32_t rank = 0;
    for (std::size_t w = 0; w < words; ++w) {
        ranks_[w] = rank;
        rank += static_cast<std::uint32_t>(std::popcount(occupied_[w]));
    }
    if (in_order) {
        starts_.push_back(static_cast<std::uint32_t>(entries));
    } else {
        starts_.assign(rank + 1, 0);
        each_entry([&](std::int32_t, std::size_t cell) { ++starts_[rank_of(cell) + 1]; });
        for (std::size_t n = 0; n < rank; ++n) starts_[n + 1] += starts_[n];
    }
    repeats_ = entries > triangles;
    if (in_order && entries == triangles) return;
    entries_.resize(entries);
    Array<std::uint32_t> next(starts_);
    each_entry([&](std::int32_t triangle, std::size_t cell) { entries_[next[rank_of(cell)]++] = triangle; });
}

}  // namespace isocore::simplification
