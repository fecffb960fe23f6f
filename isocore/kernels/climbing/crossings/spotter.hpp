// spotter.hpp - Finds where grid edges of a block are crossed, as many at once as there are lanes.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "climbing/vectors.hpp"
#include "common/crossing.hpp"
#include "common/lanes.hpp"
#include "samples/sample_reader.hpp"

namespace isocore::climbing {

template <std::size_t room>
class Spotter {
  public:
    using Numbers = Lanes<float>;

    explicit Spotter(const SampleReader& samples) : samples_(samples) {}

    bool full() const { return size_ == room; }

    // Adds a crossed edge, to be seen from the sample `from`.
    void add(const Edge& edge, const std::array<std::uint8_t, 3>& from = {}) {
        edges_[size_] = edge;
        for (std::size_t a = 0; a < 3; ++a) starts_[a][size_] = static_cast<float>(edge.at(a) - from[a]);
        axes_[size_++] = static_cast<float>(edge.axis());
    }

    // Calls visit(places, shares, first, count) for all that were added, which belong to the block at `origin`, in
    // their order, `count` lanes at a time, and forgets them. Places are multiplied by `scale`; a share is how far
    // along its edge a crossing is, from 0 to 1.
    template <class Visit>
    void visit(const Dims& origin, const Spot& scale, const Visit& visit) {
        samples_.quotients(origin, {edges_.data(), size_}, parts_.data(), wholes_.data());
        const Numbers zero(0.0f), lowest(static_cast<float>(kClamp)), highest(static_cast<float>(1 - kClamp));
        for (std::size_t n = 0; n < size_; n += kLanes<float>) {
            const Numbers share =
                least(highest, greatest(lowest, Numbers(parts_.data() + n) / Numbers(wholes_.data() + n)));
            const Numbers axis(axes_.data() + n);
            Vector<Numbers> places;
            for (std::size_t a = 0; a < 3; ++a) {
                const Numbers along = choose(axis == static_cast<float>(a), share, zero);
                places[a] = (Numbers(starts_[a].data() + n) + along) * scale[a];
            }
            visit(places, share, n, std::min(kLanes<float>, size_ - n));
        }
        size_ = 0;
    }

  private:
    using Row = std::array<float, room + kLanes<float>>;

    const SampleReader& samples_;
    std::size_t size_ = 0;
    std::array<Edge, room> edges_;
    Vector<Row> starts_;
    Row axes_, parts_, wholes_;
};

}  // namespace isocore::climbing
