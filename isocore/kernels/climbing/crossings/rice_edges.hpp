// rice_edges.hpp - The grid edges of a block that lie on the edges of its highrices, a bit each. The crossed ones among
// them are the vertices that the block asks for.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "climbing/crossings/layout.hpp"
#include "climbing/crossings/site.hpp"
#include "climbing/high_rice.hpp"

namespace isocore::climbing {

// Instantiated in rice_edges.cpp for N = 1, 2, 4, 8, 16 and 32.
template <int N>
class RiceEdges {
  public:
    void clear() { rows_ = {}; }

    // Adds the twelve edges of each box.
    void add(std::span<const HighRice> boxes);
    // Adds the edges of single cells; cells[j + N k]: those of row (j, k), a bit each.
    void add_cells(const std::array<std::uint32_t, N * N>& cells);

    // Keeps the crossings on all edges that were added. The site is loaded with the block.
    void keep(const Site& site, Layout& layout) const;

  private:
    void add(const HighRice& box);
    void add_cells(int j, int k, std::uint64_t cells);

    static std::size_t index(int j, int k) { return static_cast<std::size_t>(j + (N + 1) * k); }
    std::array<std::uint64_t, 3>& at(int j, int k) { return rows_[index(j, k)]; }

    // By row (j, k): the edges along each axis that start in it, bit i at sample i.
    std::array<std::array<std::uint64_t, 3>, (N + 1) * (N + 1)> rows_;
};

}  // namespace isocore::climbing
