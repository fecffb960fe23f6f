// ruler.hpp - Measures highrices: how far the crossings in a box that are not drawn lie from its triangles.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "climbing/bars.hpp"
#include "climbing/climb.hpp"
#include "climbing/deviation.hpp"
#include "climbing/polygon.hpp"
#include "climbing/site.hpp"
#include "common/array.hpp"
#include "common/edge_vertices.hpp"

namespace isocore::climbing {

template <class Sample, class Coordinate>
class Ruler {
  public:
    Ruler(const GridView<Sample>& samples, const SignGrid& signs, const Options& options) : samples_(samples), signs_(signs), options_(options) {
        const auto& s = options.spacing;
        even_ = s[0] == s[1] && s[1] == s[2];
        const auto samples_in_face = static_cast<std::size_t>((options.block_size + 1) * (options.block_size + 1));
        for (auto& axis : places_) axis.resize(3 * samples_in_face + kLanes<double>);  // no lign of a box is crossed twice
    }

    // Adds a box's deviations to those of its bar. False if one breaks the bound.
    bool measure(const Site& site, const HighRice& box, const Polygon& polygon, const std::vector<Polygon::Triangle>& triangles, Bar& bar) {
        // Relative to a vertex of the box, where numbers are small.
        const Corner& near = polygon.corners.front();
        count_ = 0;
        gather(site, box, near.place);
        if (count_ == 0) return true;
        for (auto& axis : places_) std::fill_n(axis.begin() + static_cast<std::ptrdiff_t>(count_), kLanes<double>, axis[0]);
        Deviation in_voxels = measure({1, 1, 1}, near.place, polygon, triangles), in_world;
        if (even_) {
            const double spacing = options_.spacing[0];
            in_world = {in_voxels.max * spacing, in_voxels.sum * spacing, in_voxels.squares * spacing * spacing};
        } else {
            in_world = measure(options_.spacing, near.place, polygon, triangles);
        }
        add(bar.in_voxels, in_voxels);
        add(bar.in_world, in_world);
        return (options_.in_world ? in_world : in_voxels).max <= options_.max_error;
    }

  private:
    // Notes the crossings that are not kept; those in a high face of the box are left to the box beyond.
    void gather(const Site& site, const HighRice& box, const Point& origin) {
        Place last;
        for (std::size_t a = 0; a < 3; ++a) last[a] = box.high[a] - (box.high[a] == site.cells[a] && site.ends_grid[a] ? 0 : 1);
        const std::uint64_t from = ~std::uint64_t{0} << box.low[0];
        const std::uint64_t along = ~(~std::uint64_t{0} << box.high[0]) & from, across = ~(~std::uint64_t{1} << last[0]) & from;
        for (int k = box.low[2]; k <= last[2]; ++k) {
            for (int j = box.low[1]; j <= last[1]; ++j) {
                const Site::Row& row = site.row(j, k);
                const std::uint64_t left[3] = {row.crossed[0] & ~row.kept[0] & along, j < box.high[1] ? row.crossed[1] & ~row.kept[1] & across : 0,
                                               k < box.high[2] ? row.crossed[2] & ~row.kept[2] & across : 0};
                if ((left[0] | left[1] | left[2]) == 0) continue;
                for (int axis = 0; axis < 3; ++axis) {
                    for (std::uint64_t bits = left[axis]; bits; bits &= bits - 1) place(site, axis, {std::countr_zero(bits), j, k}, origin);
                }
            }
        }
    }

    // Notes marching cubes' vertex.
    void place(const Site& site, int axis, const Place& at, const Point& origin) {
        const auto whole = [&](std::size_t a) { return site.origin[a] + static_cast<std::size_t>(at[a]); };
        const double crossing = edge_crossing(samples_, signs_, options_.isovalue, axis, whole(0), whole(1), whole(2));
        for (std::size_t a = 0; a < 3; ++a) {
            double place = static_cast<double>(whole(a)) - static_cast<double>(signs_.pad);
            if (static_cast<int>(a) == axis) place = static_cast<double>(static_cast<Coordinate>(place + crossing));
            places_[a][count_] = place - origin[a];
        }
        ++count_;
    }

    // The deviations of the noted places, stretched by `scale`.
    Deviation measure(const Point& scale, const Point& origin, const Polygon& polygon, const std::vector<Polygon::Triangle>& triangles) {
        const auto corner = [&](std::size_t n) {
            Point out;
            for (std::size_t a = 0; a < 3; ++a) out[a] = (polygon.corners[n].place[a] - origin[a]) * scale[a];
            return out;
        };
        facets_.clear();
        for (const auto& [a, b, c] : triangles) facets_.add(corner(a), corner(b), corner(c));
        facets_.prepare();
        Facets::Numbers largest(0.0), sum(0.0), squares(0.0);
        for (std::size_t n = 0; n < count_; n += kLanes<double>) {
            const auto axis = [&](std::size_t a) { return Facets::Numbers(places_[a].data() + n) * scale[a]; };
            const auto used = Facets::Numbers(kLaneNumbers.data()) < static_cast<double>(count_ - n);
            const Facets::Numbers found = choose(used, facets_.squared_distances({axis(0), axis(1), axis(2)}), 0.0);
            largest = greatest(largest, found);
            squares = squares + found;
            sum = sum + root(found);
        }
        Deviation out;
        for (std::size_t lane = 0; lane < kLanes<double>; ++lane) {
            out.max = std::max(out.max, largest.each()[lane]);
            out.sum += sum.each()[lane];
            out.squares += squares.each()[lane];
        }
        out.max = std::sqrt(out.max);
        return out;
    }

    static constexpr std::array<double, kLanes<double>> kLaneNumbers{0, 1, 2, 3};

    const GridView<Sample>& samples_;
    const SignGrid& signs_;
    const Options& options_;
    bool even_;
    std::array<Array<double>, 3> places_;
    std::size_t count_ = 0;
    Facets facets_;
};

}  // namespace isocore::climbing
