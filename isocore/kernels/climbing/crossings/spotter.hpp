// spotter.hpp - Finds where grid edges of a block are crossed: edges are collected first, then crossings are computed
// as many at once as a vector register has lanes.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "common/crossing.hpp"
#include "common/lanes.hpp"
#include "common/vectors.hpp"
#include "samples/sample_reader.hpp"

namespace isocore::climbing {

// Takes up to `room` edges.
template <std::size_t room>
class Spotter {
  public:
    explicit Spotter(const SampleReader& samples) : samples_(samples) {}

    bool full() const { return size_ == room; }

    // Adds a crossed edge; its place will be relative to the sample `from`.
    void add(const Edge& edge, const std::array<std::uint8_t, 3>& from = {}) {
        edges_[size_] = edge;
        for (std::size_t a = 0; a < 3; ++a) starts_[a][size_] = static_cast<float>(edge.at(a) - from[a]);
        axes_[size_++] = static_cast<float>(edge.axis());
    }

    // Finds the crossings of all edges that were added, which belong to the block at `origin`, and forgets the edges.
    // Calls visit(places, shares, first, count) for the `count` edges from the one that was added as number `first` on,
    // one lane each. shares: where each is crossed, t in [0, 1] along its edge. places: the crossings, relative to
    // `from`, times `scale`.
    template <class Visit>
    void visit(const Dims& origin, const Spot& scale, const Visit& visit) {
        samples_.quotients(origin, {edges_.data(), size_}, parts_.data(), wholes_.data());
        const Floats zero(0.0f), lowest(static_cast<float>(kClamp)), highest(static_cast<float>(1 - kClamp));
        for (std::size_t n = 0; n < size_; n += kLanes) {
            const Floats share =
                least(highest, greatest(lowest, Floats(parts_.data() + n) / Floats(wholes_.data() + n)));
            const Floats axis(axes_.data() + n);
            Vector<Floats> places;
            for (std::size_t a = 0; a < 3; ++a) {
                const Floats along = choose(axis == static_cast<float>(a), share, zero);
                places[a] = (Floats(starts_[a].data() + n) + along) * scale[a];
            }
            visit(places, share, n, std::min(kLanes, size_ - n));
        }
        size_ = 0;
    }

  private:
    using NumberPerEdge = std::array<float, room + kLanes>;  // the last register may reach past the last edge

    const SampleReader& samples_;
    std::size_t size_ = 0;
    std::array<Edge, room> edges_;
    Vector<NumberPerEdge> starts_;
    NumberPerEdge axes_, parts_, wholes_;
};

}  // namespace isocore::climbing
