// ruler.hpp - Measures highrices, many at a time: how far the dropped crossings of a box (marching cubes' vertices that
// our mesh does not have) lie from the triangles of that box. Sums go to the bar, and so does the number of each box
// that breaks the error bound.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

#include "climbing/boxes/bars.hpp"
#include "climbing/crossings/spotter.hpp"
#include "climbing/error/deviation.hpp"
#include "climbing/triangles/box_edges.hpp"
#include "climbing/types.hpp"
#include "common/facets.hpp"
#include "common/vectors.hpp"

namespace isocore::climbing {

// For each list of box edges: place(), then for each of its boxes begin_box(), add() for each triangle, end_box(); then
// measure(). After the last list of a bar: take().
class Ruler {
  public:
    Ruler(const SampleReader& samples, const Options& options);

    // Finds where the dropped crossings of the boxes are, relative to their boxes' low ends. origin: of their block.
    void place(const Dims& origin, const BoxEdges& edges);

    // Goes to the bar's box of this number, counted over its boxes of several cells. Its dropped crossings are `count`
    // of edges.dropped() from `first` on, and it has this many triangles. May measure the boxes before it.
    void begin_box(std::size_t number, std::size_t first, std::size_t count, std::size_t triangles, Bar& bar);
    // Adds a triangle; corners in samples, relative to the box's low end.
    void add(const Spot& a, const Spot& b, const Spot& c);
    void end_box(Bar& bar);

    // Measures the boxes that were begun and are not measured yet, and appends the numbers of those that break the
    // bound to bar.broken.
    void measure(Bar& bar);

    // Adds to the bar's deviations what was measured since the last call.
    void take(Bar& bar);

  private:
    using PerCrossing = std::array<float, BoxEdges::kMostEdges + kLanes>;
    static constexpr std::size_t kPlacedAtOnce = 256;  // crossings

    struct WaitingBox {
        std::size_t number, triangles, first, crossings;
    };
    // What is measured in voxels, or in the world.
    struct Measured {
        Tally tally;
        Facets facets;
        Vector<PerCrossing> places;  // of edges.dropped()
    };

    void measure(Measured& measured, Bar* bar);
    Spot stretched(const Spot& place) const {
        return {place[0] * stretch_[0], place[1] * stretch_[1], place[2] * stretch_[2]};
    }

    const Options& options_;
    double unit_;   // of lengths in the world: the longest spacing, as squares of very small numbers would underflow
    Spot stretch_;  // from samples to that unit
    float limit_;   // the error bound, in voxels or in that unit
    std::vector<WaitingBox> boxes_;
    std::size_t crossings_ = 0;  // of all these boxes
    Spotter<kPlacedAtOnce> spotter_;
    PerCrossing squared_;  // distances
    Measured voxels_;
    std::unique_ptr<Measured> world_;  // null where a voxel is equally long along all axes: then voxels_ tells both
};

// Inline, as it is called for every triangle.
inline void Ruler::add(const Spot& a, const Spot& b, const Spot& c) {
    voxels_.facets.add(a, b, c);
    if (world_) world_->facets.add(stretched(a), stretched(b), stretched(c));
}

}  // namespace isocore::climbing
