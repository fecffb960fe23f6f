// ruler.hpp - Measures highrices, many at a time: how far the crossings in a box that are not drawn lie from its triangles.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

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

    // Notes a box of the block at `origin`, the one of that number in its bar, and its crossings that are not drawn. The
    // polygon is relative to the box.
    void add(const Dims& origin, const HighRice& box, std::size_t number, std::span<const Edge> dropped, const Polygon& polygon,
             std::span<const Polygon::Triangle> triangles, Bar& bar) {
        if (dropped.empty()) return;
        if (spotter_.size() + dropped.size() > Spotter<Sample>::kRoom || in_voxels_.size() + triangles.size() > Facets::kRoom) measure(bar);
        for (const Edge& edge : dropped) spotter_.add(origin, static_cast<int>(edge.axis()), edge.at(), box.low);
        for (const Polygon::Triangle& triangle : triangles) {
            const Spot a = polygon.place(triangle[0]), b = polygon.place(triangle[1]), c = polygon.place(triangle[2]);
            in_voxels_.add(a, b, c);
            if (!even_) in_world_.add(stretched(a, stretch_), stretched(b, stretch_), stretched(c, stretch_));
        }
        boxes_.push_back({number, triangles.size(), dropped.size()});
        if (in_voxels_.size() > kWorthwhile) measure(bar);
    }

    // Adds to a bar what was noted since the last time.
    void take(Bar& bar) {
        measure(bar);
        isocore::climbing::add(bar.in_voxels, voxels_.sum_up(1));
        isocore::climbing::add(bar.in_world, (even_ ? voxels_ : world_).sum_up(unit_));
        voxels_ = world_ = {};
    }

  private:
    using Numbers = Lanes<float>;
    using Row = std::array<float, Spotter<Sample>::kRoom + kLanes<float>>;
    static constexpr Spot kNoStretch{1, 1, 1};
    static constexpr std::size_t kWorthwhile = 96;  // triangles

    struct Box {
        std::size_t number, triangles, crossings;
    };

    static Spot stretched(const Spot& place, const Spot& stretch) { return {place[0] * stretch[0], place[1] * stretch[1], place[2] * stretch[2]}; }

    // Measures the boxes that were added. Those that break the bound are noted in bar.broken.
    void measure(Bar& bar) {
        spotter_.visit(kNoStretch, [&](const Vector<Numbers>& places, const Numbers&, std::size_t first, std::size_t) {
            for (std::size_t a = 0; a < 3; ++a) {
                places[a].store(places_[a].data() + first);
                if (!even_) (places[a] * stretch_[a]).store(places_in_world_[a].data() + first);
            }
        });
        Bar* const judged = std::isfinite(limit_) ? &bar : nullptr;
        measure(in_voxels_, places_, voxels_, even_ || !options_.in_world ? judged : nullptr);
        if (!even_) measure(in_world_, places_in_world_, world_, options_.in_world ? judged : nullptr);
        boxes_.clear();
    }

    void measure(Facets& facets, const Vector<Row>& places, Tally& tally, Bar* bar) {
        facets.find_frames();
        std::size_t triangle = 0, crossing = 0;
        for (const Box& box : boxes_) {
            float* const squared = squared_.data() + crossing;
            const Vector<const float*> points{places[0].data() + crossing, places[1].data() + crossing, places[2].data() + crossing};
            facets.squared_distances(triangle, box.triangles, points, box.crossings, squared);
            if (bar && std::sqrt(*std::max_element(squared, squared + box.crossings)) > limit_) bar->broken.push_back(box.number);
            triangle += box.triangles;
            crossing += box.crossings;
        }
        for (std::size_t n = 0; n < crossing; n += kLanes<float>) {
            const Numbers squared = first_lanes(Numbers(squared_.data() + n), std::min(kLanes<float>, crossing - n), 0.0f);
            tally.add(root(squared), squared);
        }
        facets.clear();
    }

    const Options& options_;
    double unit_;   // of distances in the world: small numbers would have their squares lost
    Spot stretch_;  // from samples to that unit
    bool even_;     // is a voxel as long along all axes?
    float limit_;
    Tally voxels_, world_;
    Facets in_voxels_, in_world_;
    Spotter<Sample> spotter_;
    std::vector<Box> boxes_;
    Vector<Row> places_, places_in_world_;  // of the crossings, relative to their boxes
    Row squared_;                           // distances
};

}  // namespace isocore::climbing
