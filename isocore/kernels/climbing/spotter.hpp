// spotter.hpp - Finds where grid edges of a block are crossed, as many at once as there are lanes.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "climbing/site.hpp"
#include "climbing/vectors.hpp"
#include "common/crossing.hpp"
#include "common/edge_vertices.hpp"
#include "common/grid.hpp"
#include "common/lanes.hpp"
#include "common/signs.hpp"

namespace isocore::climbing {

template <class Sample, std::size_t room>
class Spotter {
  public:
    using Numbers = Lanes<float>;

    Spotter(const GridView<Sample>& samples, const SignGrid& signs, double isovalue)
        : samples_(samples), signs_(signs), isovalue_(isovalue) {}

    bool full() const { return size_ == room; }

    // Adds the crossed edge along `axis` that starts at the sample `at` of the block at `origin`, as seen from the
    // sample `from`.
    void add(const Dims& origin, int axis, const Place& at, const std::array<std::uint8_t, 3>& from = {}) {
        const auto whole = [&](std::size_t a) { return origin[a] + static_cast<std::size_t>(at[a]); };
        for (std::size_t a = 0; a < 3; ++a) starts_[a][size_] = static_cast<float>(at[a] - from[a]);
        axes_[size_] = static_cast<float>(axis);
        const Quotient crossing = edge_quotient(samples_, signs_, isovalue_, axis, whole(0), whole(1), whole(2));
        parts_[size_] = crossing.part;
        wholes_[size_++] = crossing.whole;
    }

    // Calls visit(places, shares, first, count) for all that were added, in their order, `count` lanes at a time, and
    // forgets them. The places are stretched; the shares are of the edges' ways.
    template <class Visit>
    void visit(const Spot& scale, const Visit& visit) {
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

    const GridView<Sample>& samples_;
    const SignGrid& signs_;
    double isovalue_;
    std::size_t size_ = 0;
    Vector<Row> starts_;
    Row axes_, parts_, wholes_;
};

}  // namespace isocore::climbing
