// drawer.hpp - From highrices to triangles, one bar at a time.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>

#include "climbing/boxes/bars.hpp"
#include "climbing/boxes/block_rices.hpp"
#include "climbing/boxes/halvings.hpp"
#include "climbing/disks.hpp"
#include "climbing/triangles/drawn_site.hpp"
#include "climbing/triangles/triangle_list.hpp"
#include "climbing/types.hpp"
#include "samples/sample_reader.hpp"
#include "tables/cell_loops.hpp"

namespace isocore::climbing {

// Draws the highrices of a bar and has them measured on the way.
class Drawer {
  public:
    Drawer(const SampleReader& samples, const SignGrid& signs, const Layout& layout, const Options& options,
           const PlacedVertices& vertices)
        : samples_(samples),
          signs_(signs),
          layout_(layout),
          site_(options.block_size),
          rices_(options.block_size),
          disks_(samples, signs, options, vertices) {}

    // Calls put(triangles) for some of a bar's triangles after the other; boxes that break the bound are noted in
    // bar.broken.
    template <class Put>
    void draw(const Bars& bars, std::size_t number, Bar& bar, const Put& put) {
        bar.triangles = 0;
        bar.ambiguous_faces = bar.ambiguous_cells = 0;
        bar.in_voxels = bar.in_world = {};
        bar.broken.clear();
        bar.stale = false;
        if (bar.blocks == 0) return;
        const auto [start, y, z] = bars.origin(number);
        site_.begin(signs_, layout_, y, z);
        HalvingsReader halvings(bar.halvings);
        disks_.begin_bar();
        for (std::size_t x = start; x + 1 < signs_.dims[0]; x += bars.block_size) {
            const Fate fate = halvings.next_block();
            if (fate == Fate::nothing) continue;
            site_.load(x);
            rices_.read(fate, halvings);
            disks_.draw(site_, rices_.boxes(), triangles_, bar);
            rices_.visit_cells(site_, [&](int j, int k, std::uint64_t cells) { draw_cells(bar, j, k, cells); });
            put(triangles_.vertices());
            bar.triangles += triangles_.size();
            triangles_.clear();
        }
        disks_.end_bar(bar);
    }

  private:
    static constexpr std::size_t kMostOfCell = cell_loops::Case{}.edges.size() / 3;  // triangles

    // Of a row, a bit each.
    void draw_cells(Bar& bar, int j, int k, std::uint64_t cells) {
        std::int32_t* out = triangles_.reserve(kMostOfCell * static_cast<std::size_t>(std::popcount(cells)));
        for (std::uint64_t left = cells; left; left &= left - 1) {
            const int x = std::countr_zero(left);
            const auto pair = [&](int right, int up) {
                return static_cast<unsigned>(site_.row(j + right, k + up).signs >> x & 3);
            };
            const unsigned corners = pair(0, 0) | pair(1, 0) << 2 | pair(0, 1) << 4 | pair(1, 1) << 6;
            const auto& entry = cell_loops::kTable.corners[corners];
            unsigned decisions = 0;
            if (entry.ambiguous) {
                const Dims cell{site_.origin[0] + static_cast<std::size_t>(x),
                                site_.origin[1] + static_cast<std::size_t>(j),
                                site_.origin[2] + static_cast<std::size_t>(k)};
                decisions = samples_.decide_faces(corners, cell);
                ++bar.ambiguous_cells;
                bar.ambiguous_faces += static_cast<std::size_t>(std::popcount(unsigned{entry.ambiguous}));
            }
            const auto numbers = edge_numbers(site_.kept_row(j, k), site_.kept_row(j + 1, k), site_.kept_row(j, k + 1),
                                              site_.kept_row(j + 1, k + 1), x);
            const auto& drawn = cell_loops::kTable.cases[entry.first + decisions];
            for (unsigned n = 0; n < 3u * drawn.triangles; ++n)
                *out++ = static_cast<std::int32_t>(numbers[drawn.edges[n]]);
        }
        triangles_.end_at(out);
    }

    // The vertices on a cell's twelve edges (cube.hpp's order); those of edges that are not crossed mean nothing.
    using KeptRow = DrawnSite::KeptRow;
    static std::array<std::uint32_t, 12> edge_numbers(const KeptRow& row, const KeptRow& right, const KeptRow& up,
                                                      const KeptRow& far, int x) {
        const std::uint64_t before = (std::uint64_t{1} << x) - 1;
        const auto number = [&](const KeptRow& from, std::size_t axis) {
            return from.first_vertex[axis] + static_cast<std::uint32_t>(std::popcount(from.kept[axis] & before));
        };
        std::array<std::uint32_t, 12> out{number(row, 0), number(right, 0), number(up, 0), number(far, 0)};
        const auto two = [&](std::size_t edge, const KeptRow& from, std::size_t axis) {
            out[edge] = number(from, axis);
            out[edge + 1] = out[edge] + static_cast<std::uint32_t>(from.kept[axis] >> x & 1);
        };
        two(4, row, 1);
        two(6, up, 1);
        two(8, row, 2);
        two(10, right, 2);
        return out;
    }

    const SampleReader& samples_;
    const SignGrid& signs_;
    const Layout& layout_;
    DrawnSite site_;
    BlockRices rices_;
    TriangleList triangles_;  // of one block
    Disks disks_;
};

}  // namespace isocore::climbing
