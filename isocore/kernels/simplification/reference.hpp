// reference.hpp - The reference surface, found by cells. Triangles of one cell follow each other, and so do cells of
// one row, so that a piece of a row is one run of triangles.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/array.hpp"
#include "simplification/cells.hpp"
#include "simplification/mesh.hpp"
#include "simplification/types.hpp"

namespace isocore::simplification {

template <class Real>
class Reference {
  public:
    Reference(const MeshArrays<Real>& mesh, const Cells& cells);

    const MeshArrays<Real>& mesh() const { return mesh_; }
    const Cells& cells() const { return cells_; }

    // visit(first, end) of each run of entries in the cells from `low` to `high`, both included. A triangle that lies
    // in several cells may have several entries there.
    template <class Visit>
    void each_run_between(const Cell& low, const Cell& high, const Visit& visit) const {
        for (std::int32_t k = low[2]; k <= high[2]; ++k) {
            for (std::int32_t j = low[1]; j <= high[1]; ++j) {
                const std::uint32_t first = first_of(number({low[0], j, k}));
                const std::uint32_t end = first_of(number({high[0], j, k}) + 1);
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
        const std::size_t first = number(cell), shift = first % 64;
        std::uint64_t bits = occupied_[first / 64] >> shift;
        if (shift > 0) bits |= occupied_[first / 64 + 1] << (64 - shift);
        return {bits & ((std::uint64_t{1} << count) - 1), starts_.data() + rank_of(first)};
    }
    // May a triangle have several entries?
    bool repeats() const { return entries_.size() > mesh_.triangle_count; }
    // Is entry n triangle n?
    bool is_in_order() const { return entries_.empty(); }
    // The triangle of an entry.
    std::int32_t entry(std::uint32_t number) const {
        return entries_.empty() ? static_cast<std::int32_t>(number) : entries_[number];
    }

    // The three vertices of a triangle.
    const std::int32_t* corners(std::int32_t triangle) const {
        return mesh_.triangles + 3 * static_cast<std::size_t>(triangle);
    }
    // x, y and z of a vertex.
    const Real* place(std::int32_t vertex) const { return mesh_.vertices + 3 * static_cast<std::size_t>(vertex); }
    bool is_in(std::int32_t triangle, std::uint32_t sheet) const {
        return mesh_.sheets == nullptr || mesh_.sheets[triangle] == sheet;
    }
    // Is a side of the triangle on its sheet's border, or could it be?
    bool may_be_at_border(std::int32_t triangle) const {
        if (!has_border_) return false;
        return at_border_[vertex(triangle, 0)] + at_border_[vertex(triangle, 1)] + at_border_[vertex(triangle, 2)] > 1;
    }

  private:
    std::size_t vertex(std::int32_t triangle, std::size_t n) const {
        return static_cast<std::size_t>(mesh_.triangles[3 * static_cast<std::size_t>(triangle) + n]);
    }
    std::size_t number(const Cell& cell) const {
        return static_cast<std::size_t>(cell[0]) +
               cells_.dims[0] *
                   (static_cast<std::size_t>(cell[1]) + cells_.dims[1] * static_cast<std::size_t>(cell[2]));
    }
    // How many occupied cells come before this one.
    std::uint32_t rank_of(std::size_t cell) const {
        const std::uint64_t below = occupied_[cell / 64] & ((std::uint64_t{1} << cell % 64) - 1);
        return ranks_[cell / 64] + static_cast<std::uint32_t>(std::popcount(below));
    }
    // The first entry of this cell or of a later one.
    std::uint32_t first_of(std::size_t cell) const { return starts_[rank_of(cell)]; }
    template <class Visit>
    void each_entry(const Visit& visit) const;
    void find_border();
    void find_curves();

    MeshArrays<Real> mesh_;
    Cells cells_;
    Array<std::uint64_t> occupied_;        // a bit for each cell
    Array<std::uint32_t> ranks_;           // of each word: how many bits are set before it
    Array<std::uint32_t> starts_;          // of each occupied cell: its first entry
    Array<std::int32_t> entries_;          // triangles; empty where entry n is triangle n
    std::vector<std::uint8_t> at_border_;  // by vertex
    bool has_border_ = false;
};

}  // namespace isocore::simplification
