// drawn_site.hpp - A site whose layout is complete: of each crossed edge it is known whether it is a vertex of the mesh
// (it was kept, by one of the block's boxes or by a neighbour's) and which number that vertex has.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "climbing/crossings/site.hpp"
#include "common/array.hpp"

namespace isocore::climbing {

class DrawnSite : public Site {
  public:
    // A window shows the edges that start at 21 neighbouring samples of a row, along all three axes, in 63 bits:
    //
    //     | 0: 63 | along z: 42..62 | along y: 21..41 | along x: 0..20 |
    //
    // so that one AND, one XOR or one popcount serves all three axes. A row has two of them: window 0 starts at sample
    // 0 and window 1 at sample 16. Boxes come from halving a block of at most 32 cells; hence each lies in samples
    // 0..16, which window 0 shows, or in 16..32, which window 1 shows, or it is 32 cells long and uses both.
    using Window = std::uint64_t;
    static constexpr int kWindowSamples = 21, kWindowStep = 16;

    // What became of the crossed edges that start in row (j, k). Kept edges are vertices; dropped edges are crossed,
    // but no vertices. A bit of `kept` is a sample of the row; the windows have the bits shown above.
    struct KeptRow {
        std::array<std::uint64_t, 3> kept{};          // along each axis
        std::array<std::uint32_t, 3> first_vertex{};  // the number of the first kept edge along each axis, if any
        std::array<Window, 2> kept_windows{}, dropped_windows{};
    };

    explicit DrawnSite(int block_size);

    // As Site's. The vertices must have been numbered by layout.number().
    void begin(const SignGrid& signs, const Layout& layout, std::size_t y, std::size_t z);
    void load(std::size_t x);

    const KeptRow& kept_row(int j, int k) const { return kept_rows_[row_index(j, k)]; }

    // The vertex on a kept edge: a rank query in its row.
    std::int32_t vertex(std::size_t axis, const Place& at) const {
        const KeptRow& here = kept_row(at[1], at[2]);
        return static_cast<std::int32_t>(here.first_vertex[axis] +
                                         ones(here.kept[axis] & ((std::uint64_t{1} << at[0]) - 1)));
    }

  private:
    Array<KeptRow> kept_rows_;
    Array<std::array<std::uint32_t, 3>> next_vertices_;  // by row: the vertex after those of the blocks loaded so far
};

}  // namespace isocore::climbing
