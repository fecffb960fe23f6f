// ruler.hpp - Measures highrices: how far the crossings in a box that are not drawn lie from its triangles.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "climbing/bars.hpp"
#include "climbing/box_edges.hpp"
#include "climbing/climb.hpp"
#include "climbing/deviation.hpp"
#include "climbing/drawn_site.hpp"
#include "climbing/polygon.hpp"
#include "common/edge_vertices.hpp"

namespace isocore::climbing {

template <class Sample, class Coordinate>
class Ruler {
  public:
    Ruler(const GridView<Sample>& samples, const SignGrid& signs, const Options& options) : samples_(samples), signs_(signs), options_(options) {
        const auto& s = options.spacing;
        even_ = s[0] == s[1] && s[1] == s[2];
    }

    // Notes the deviations of a box, by its crossings that are not drawn. False if one breaks the bound.
    bool measure(const DrawnSite& site, std::span<const Edge> dropped, const Polygon& polygon, std::span<const Polygon::Triangle> triangles) {
        if (dropped.empty()) return true;
        const Point& origin = polygon[0].place;  // numbers are small when taken from there
        prepare(in_voxels_, {1, 1, 1}, polygon, triangles);
        if (!even_) prepare(in_world_, options_.spacing, polygon, triangles);
        double largest = 0, largest_in_world = 0;
        for (const Edge& edge : dropped) {
            Point place = vertex(site, edge);
            for (std::size_t a = 0; a < 3; ++a) place[a] -= origin[a];
            largest = std::max(largest, add(voxels_, in_voxels_.squared_distance(place)));
            if (even_) continue;
            for (std::size_t a = 0; a < 3; ++a) place[a] *= options_.spacing[a];
            largest_in_world = std::max(largest_in_world, add(world_, in_world_.squared_distance(place)));
        }
        if (options_.in_world) return (even_ ? largest * options_.spacing[0] : largest_in_world) <= options_.max_error;
        return largest <= options_.max_error;
    }

    // Adds to a bar what was noted since the last time.
    void take(Bar& bar) {
        const double spacing = options_.spacing[0];
        if (even_) world_ = {voxels_.max * spacing, voxels_.sum * spacing, voxels_.squares * spacing * spacing};
        add(bar.in_voxels, voxels_);
        add(bar.in_world, world_);
        voxels_ = world_ = {};
    }

  private:
    // Stretched by `scale`, and relative to the first corner.
    static void prepare(Facets& facets, const Point& scale, const Polygon& polygon, std::span<const Polygon::Triangle> triangles) {
        const Point& origin = polygon[0].place;
        facets.take(triangles.size(), [&](std::size_t triangle, std::size_t corner) {
            const Point& place = polygon[triangles[triangle][corner]].place;
            return Point{(place[0] - origin[0]) * scale[0], (place[1] - origin[1]) * scale[1], (place[2] - origin[2]) * scale[2]};
        });
    }

    // Marching cubes' vertex.
    Point vertex(const DrawnSite& site, const Edge& edge) const {
        const auto whole = [&](std::size_t a) { return site.origin[a] + edge.at[a]; };
        std::array<Coordinate, 3> place;
        write_vertex(samples_, signs_, options_.isovalue, edge.axis, whole(0), whole(1), whole(2), place.data());
        return {place[0], place[1], place[2]};
    }

    const GridView<Sample>& samples_;
    const SignGrid& signs_;
    const Options& options_;
    bool even_;
    Deviation voxels_, world_;  // noted
    Facets in_voxels_, in_world_;
};

}  // namespace isocore::climbing
