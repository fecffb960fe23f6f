// drawer.hpp - From highrices to triangles, one bar at a time, and the deviation of what is not drawn.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "climbing/bars.hpp"
#include "climbing/climb.hpp"
#include "climbing/crossings.hpp"
#include "climbing/deviation.hpp"
#include "climbing/padi.hpp"
#include "climbing/polygon.hpp"
#include "climbing/site.hpp"
#include "common/decider.hpp"
#include "common/edge_vertices.hpp"

namespace isocore::climbing {

// The crossed edges of a cell, by its corner signs.
inline constexpr std::array<std::uint16_t, 256> kCrossed = [] {
    std::array<std::uint16_t, 256> crossed{};
    for (unsigned corners = 0; corners < 256; ++corners) {
        for (int edge = 0; edge < 12; ++edge) {
            const unsigned low = corners >> cube::low_corner(edge) & 1, high = corners >> cube::high_corner(edge) & 1;
            crossed[corners] |= static_cast<std::uint16_t>((low ^ high) << edge);
        }
    }
    return crossed;
}();

// Draws the highrices of a bar and measures them on the way.
template <class Sample, class Coordinate>
class Drawer {
  public:
    Drawer(const GridView<Sample>& samples, const SignGrid& signs, const Layout& layout, const Options& options, const Coordinate* vertices)
        : samples_(samples), signs_(signs), layout_(layout), options_(options), vertices_(vertices), site_(options.block_size) {
        const auto& s = options.spacing;
        even_ = s[0] == s[1] && s[1] == s[2];
    }

    // Writes the triangles from `out` on and returns the end; boxes that break the bound are noted in bar.broken.
    std::int32_t* draw(const Bars& bars, std::size_t number, Bar& bar, std::int32_t* out) {
        bar.ambiguous_faces = bar.ambiguous_cells = 0;
        bar.in_voxels = bar.in_world = {};
        bar.broken.clear();
        bars.visit(number, [&](const Dims& origin, const HighRice* box, const HighRice* end) {
            site_.load(signs_, layout_, origin);
            for (; box != end; ++box) {
                const unsigned corners = site_.corners(*box);
                if (box->is_cell()) {
                    out = draw_cell(bar, *box, corners, out);
                } else {
                    out = draw_disk(*box, corners, out);
                    if (options_.measured && !measure(bar, *box)) bar.broken.push_back(static_cast<std::size_t>(box - bar.boxes.data()));
                }
            }
        });
        bar.stale = false;
        return out;
    }

  private:
    std::int32_t* draw_cell(Bar& bar, const HighRice& box, unsigned corners, std::int32_t* out) {
        const auto& entry = cell_loops::kTable.corners[corners];
        unsigned decisions = 0;
        if (entry.ambiguous) {
            const Dims cell{site_.origin[0] + box.low[0], site_.origin[1] + box.low[1], site_.origin[2] + box.low[2]};
            decisions = decide_faces(samples_, signs_.pad, options_.isovalue, corners, cell);
            ++bar.ambiguous_cells;
            bar.ambiguous_faces += static_cast<std::size_t>(std::popcount(unsigned{entry.ambiguous}));
        }
        std::array<std::int32_t, 12> numbers;
        for (unsigned left = kCrossed[corners]; left; left &= left - 1) {
            const int edge = std::countr_zero(left), corner = cube::low_corner(edge);
            numbers[static_cast<std::size_t>(edge)] =
                site_.vertex(edge / 4, {box.low[0] + (corner & 1), box.low[1] + (corner >> 1 & 1), box.low[2] + (corner >> 2)});
        }
        const auto& drawn = cell_loops::kTable.cases[entry.first + decisions];
        for (unsigned n = 0; n < 3u * drawn.triangles; ++n) *out++ = numbers[drawn.edges[n]];
        return out;
    }

    std::int32_t* draw_disk(const HighRice& box, unsigned corners, std::int32_t* out) {
        walk_.loop(site_, box, kRims[corners], loop_);
        polygon_.corners.clear();
        for (const RimEdge& edge : loop_) {
            const std::int32_t number = site_.vertex(edge.axis, edge.at);
            const Coordinate* place = vertices_ + 3 * static_cast<std::size_t>(number);
            polygon_.corners.push_back({{place[0], place[1], place[2]}, edge.faces, number});
        }
        facets_.clear();
        stretched_.clear();
        polygon_.cut([&](std::size_t a, std::size_t b, std::size_t c) {
            for (const std::size_t n : {a, b, c}) *out++ = polygon_.corners[n].vertex;
            if (!options_.measured) return;
            const Point &p = polygon_.corners[a].place, &q = polygon_.corners[b].place, &r = polygon_.corners[c].place;
            facets_.emplace_back(p, q, r);
            if (!even_) stretched_.emplace_back(stretch(p), stretch(q), stretch(r));
        });
        return out;
    }

    // Adds the deviations of the crossings that are not drawn. False if one breaks the bound.
    bool measure(Bar& bar, const HighRice& box) {
        Place last;
        for (std::size_t a = 0; a < 3; ++a) last[a] = box.high[a] - (box.high[a] == site_.cells[a] && site_.ends_grid[a] ? 0 : 1);
        Deviation in_voxels, in_world;
        visit_edges(
            box, last, [&](int axis, int j, int k) { return site_.crossed(axis, j, k) & ~site_.kept(axis, j, k); },
            [&](int axis, const Place& at) {
                const Point p = place(axis, at);
                const double distance = distance_to(facets_, p);
                add(in_voxels, distance);
                add(in_world, even_ ? distance * options_.spacing[0] : distance_to(stretched_, stretch(p)));
            });
        add(bar.in_voxels, in_voxels);
        add(bar.in_world, in_world);
        return (options_.in_world ? in_world : in_voxels).max <= options_.max_error;
    }

    Point stretch(const Point& p) const { return {p[0] * options_.spacing[0], p[1] * options_.spacing[1], p[2] * options_.spacing[2]}; }

    // Marching cubes' vertex.
    Point place(int axis, const Place& at) const {
        const auto whole = [&](std::size_t a) { return site_.origin[a] + static_cast<std::size_t>(at[a]); };
        Point p{static_cast<double>(whole(0)), static_cast<double>(whole(1)), static_cast<double>(whole(2))};
        p[static_cast<std::size_t>(axis)] += edge_crossing(samples_, signs_, options_.isovalue, axis, whole(0), whole(1), whole(2));
        for (double& x : p) x = static_cast<double>(static_cast<Coordinate>(x - static_cast<double>(signs_.pad)));
        return p;
    }

    const GridView<Sample>& samples_;
    const SignGrid& signs_;
    const Layout& layout_;
    const Options& options_;
    const Coordinate* vertices_;
    bool even_;
    Site site_;
    RimWalk walk_;
    std::vector<RimEdge> loop_;
    Polygon polygon_;
    std::vector<Facet> facets_, stretched_;
};

}  // namespace isocore::climbing
