// drawer.hpp - From highrices to triangles, one bar at a time.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "climbing/bars.hpp"
#include "climbing/climb.hpp"
#include "climbing/padi.hpp"
#include "climbing/polygon.hpp"
#include "climbing/ruler.hpp"
#include "climbing/site.hpp"
#include "common/decider.hpp"

namespace isocore::climbing {

// Draws the highrices of a bar and has them measured on the way.
template <class Sample, class Coordinate>
class Drawer {
  public:
    Drawer(const GridView<Sample>& samples, const SignGrid& signs, const Layout& layout, const Options& options, const Coordinate* vertices)
        : samples_(samples), signs_(signs), layout_(layout), options_(options), vertices_(vertices), site_(options.block_size), ruler_(samples, signs, options) {}

    // Writes the triangles from `out` on and returns the end; boxes that break the bound are noted in bar.broken.
    std::int32_t* draw(const Bars& bars, std::size_t number, Bar& bar, std::int32_t* out) {
        bar.ambiguous_faces = bar.ambiguous_cells = 0;
        bar.in_voxels = bar.in_world = {};
        bar.broken.clear();
        bar.stale = false;
        if (bar.blocks.empty()) return out;
        site_.begin_with_vertices(signs_, layout_, bars.block_size * (number % bars.blocks[1]), bars.block_size * (number / bars.blocks[1]));
        bars.visit(number, [&](const Dims& origin, std::span<const HighRice> boxes, std::span<const CellRow> cell_rows) {
            site_.load_with_vertices(origin[0]);
            for (const HighRice& box : boxes) {
                out = draw_disk(box, out);
                if (options_.measured && !ruler_.measure(site_, box, polygon_, triangles_, bar)) {
                    bar.broken.push_back(static_cast<std::size_t>(&box - bar.boxes.data()));
                }
            }
            for (const CellRow& row : cell_rows) out = draw_cells(bar, row, out);
        });
        return out;
    }

  private:
    std::int32_t* draw_cells(Bar& bar, const CellRow& cells, std::int32_t* out) {
        const int j = cells.j, k = cells.k;
        const Site::Row &row = site_.row(j, k), &right = site_.row(j + 1, k), &up = site_.row(j, k + 1), &far = site_.row(j + 1, k + 1);
        for (std::uint64_t left = cells.cells; left; left &= left - 1) {
            const int x = std::countr_zero(left);
            const auto pair = [&](const Site::Row& from) { return static_cast<unsigned>(from.signs >> x & 3); };
            const unsigned corners = pair(row) | pair(right) << 2 | pair(up) << 4 | pair(far) << 6;
            const auto& entry = cell_loops::kTable.corners[corners];
            unsigned decisions = 0;
            if (entry.ambiguous) {
                const Dims cell{site_.origin[0] + static_cast<std::size_t>(x), site_.origin[1] + cells.j, site_.origin[2] + cells.k};
                decisions = decide_faces(samples_, signs_.pad, options_.isovalue, corners, cell);
                ++bar.ambiguous_cells;
                bar.ambiguous_faces += static_cast<std::size_t>(std::popcount(unsigned{entry.ambiguous}));
            }
            const auto numbers = edge_numbers(row, right, up, far, x);
            const auto& drawn = cell_loops::kTable.cases[entry.first + decisions];
            for (unsigned n = 0; n < 3u * drawn.triangles; ++n) *out++ = static_cast<std::int32_t>(numbers[drawn.edges[n]]);
        }
        return out;
    }

    // The vertices on a cell's twelve edges (cube.hpp's order); those of edges that are not crossed mean nothing.
    static std::array<std::uint32_t, 12> edge_numbers(const Site::Row& row, const Site::Row& right, const Site::Row& up, const Site::Row& far, int x) {
        const std::uint64_t before = (std::uint64_t{1} << x) - 1;
        const auto number = [&](const Site::Row& from, std::size_t axis) {
            return from.first_vertex[axis] + static_cast<std::uint32_t>(std::popcount(from.kept[axis] & before));
        };
        std::array<std::uint32_t, 12> out{number(row, 0), number(right, 0), number(up, 0), number(far, 0)};
        const auto two = [&](std::size_t edge, const Site::Row& from, std::size_t axis) {
            out[edge] = number(from, axis);
            out[edge + 1] = out[edge] + static_cast<std::uint32_t>(from.kept[axis] >> x & 1);
        };
        two(4, row, 1);
        two(6, up, 1);
        two(8, row, 2);
        two(10, right, 2);
        return out;
    }

    std::int32_t* draw_disk(const HighRice& box, std::int32_t* out) {
        polygon_.corners.clear();
        padi::walk_loop(site_, box, kRims[site_.corners(box)], [&](const RimEdge& edge, unsigned faces) {
            const std::int32_t number = site_.vertex(edge.axis, edge.at);
            const Coordinate* place = vertices_ + 3 * static_cast<std::size_t>(number);
            polygon_.corners.push_back({{place[0], place[1], place[2]}, faces, number});
        });
        triangles_.clear();
        polygon_.cut([&](std::size_t a, std::size_t b, std::size_t c) {
            for (const std::size_t n : {a, b, c}) *out++ = polygon_.corners[n].vertex;
            triangles_.push_back({a, b, c});
        });
        return out;
    }

    const GridView<Sample>& samples_;
    const SignGrid& signs_;
    const Layout& layout_;
    const Options& options_;
    const Coordinate* vertices_;
    Site site_;
    Polygon polygon_;
    std::vector<Polygon::Triangle> triangles_;
    Ruler<Sample, Coordinate> ruler_;
};

}  // namespace isocore::climbing
