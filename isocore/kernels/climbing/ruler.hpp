// ruler.hpp - Measures highrices: how far the crossings in a box that are not drawn lie from its triangles.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "climbing/bars.hpp"
#include "climbing/box_edges.hpp"
#include "climbing/climb.hpp"
#include "climbing/deviation.hpp"
#include "climbing/facets.hpp"
#include "climbing/polygon.hpp"
#include "climbing/spotter.hpp"
#include "climbing/vectors.hpp"

namespace isocore::climbing {

template <class Sample>
class Ruler {
  public:
    Ruler(const GridView<Sample>& samples, const SignGrid& signs, const Options& options)
        : options_(options), unit_(*std::max_element(options.spacing.begin(), options.spacing.end())), spotter_(samples, signs, options.isovalue) {
        for (std::size_t a = 0; a < 3; ++a) stretch_[a] = static_cast<float>(options.spacing[a] / unit_);
        even_ = stretch_ == kNoStretch;
        // In the units of the distances, and rounded down.
        const double unit = options.in_world ? unit_ : 1;
        limit_ = static_cast<float>(options.max_error / unit);
        while (static_cast<double>(limit_) * unit > options.max_error) limit_ = std::nextafter(limit_, 0.0f);
    }

    // Notes the deviations of a box of the block at `origin`, by its crossings that are not drawn. The polygon is relative to
    // the box. False if the box breaks the bound.
    bool measure(const Dims& origin, const HighRice& box, std::span<const Edge> dropped, const Polygon& polygon, std::span<const Polygon::Triangle> triangles) {
        if (dropped.empty()) return true;
        for (const Edge& edge : dropped) spotter_.add(origin, static_cast<int>(edge.axis()), edge.at());
        const auto corner = [&](std::size_t triangle, std::size_t c) { return polygon.place(triangles[triangle][c]); };
        in_voxels_.take(triangles.size(), corner);
        if (!even_) in_world_.take(triangles.size(), [&](std::size_t triangle, std::size_t c) { return stretched(corner(triangle, c), stretch_); });
        bool broken = false;
        const Spot low{static_cast<float>(box.low[0]), static_cast<float>(box.low[1]), static_cast<float>(box.low[2])};
        spotter_.visit(low, kNoStretch, [&](const Vector<Numbers>& places, const Numbers&, std::size_t, std::size_t count) {
            const auto distances = note(voxels_, in_voxels_, places, count);
            if (even_ || !options_.in_world) broken |= (Numbers(limit_) < distances).any();
            if (even_) return;
            const Vector<Numbers> stretch{stretch_[0], stretch_[1], stretch_[2]};
            const auto in_world = note(world_, in_world_, stretched(places, stretch), count);
            if (options_.in_world) broken |= (Numbers(limit_) < in_world).any();
        });
        return !broken;
    }

    // Adds to a bar what was noted since the last time.
    void take(Bar& bar) {
        add(bar.in_voxels, voxels_.sum_up(1));
        add(bar.in_world, (even_ ? voxels_ : world_).sum_up(unit_));
        voxels_ = world_ = {};
    }

  private:
    using Numbers = Lanes<float>;
    static constexpr Spot kNoStretch{1, 1, 1};

    template <class Number>
    static Vector<Number> stretched(const Vector<Number>& place, const Vector<Number>& stretch) {
        return {place[0] * stretch[0], place[1] * stretch[1], place[2] * stretch[2]};
    }

    static Numbers note(Tally& tally, const Facets& facets, const Vector<Numbers>& places, std::size_t count) {
        const Numbers squared = facets.squared_distances(places, count), distances = root(squared);
        tally.add(distances, squared);
        return distances;
    }

    const Options& options_;
    double unit_;   // of distances in the world: small numbers would have their squares lost
    Spot stretch_;  // from samples to that unit
    bool even_;     // is a voxel as long along all axes?
    float limit_;
    Tally voxels_, world_;
    Facets in_voxels_, in_world_;
    Spotter<Sample> spotter_;
};

}  // namespace isocore::climbing
