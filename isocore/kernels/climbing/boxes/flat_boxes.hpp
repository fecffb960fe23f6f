// flat_boxes.hpp - Which boxes of a block are flat enough for the error bound. A box is met on many ways down from the
// block, so what is found out about it is remembered.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "climbing/boxes/dyadic_box.hpp"
#include "climbing/boxes/flatness.hpp"
#include "climbing/crossings/cloud.hpp"
#include "climbing/crossings/gatherer.hpp"
#include "climbing/crossings/ligns.hpp"
#include "climbing/crossings/rim.hpp"
#include "climbing/crossings/site.hpp"
#include "tables/rims.hpp"

namespace isocore::climbing {

template <int N>
class FlatBoxes {
  public:
    explicit FlatBoxes(const Gatherer& gatherer)
        : gatherer_(gatherer), flat_(gatherer.max_error), ligns_(N + 1), clouds_(N) {}

    // Gathers the crossings of the block that the site is loaded with, and returns them all; forgets all answers.
    Cloud begin(const Site& site) {
        asked_ = {};
        passed_ = {};
        std::size_t crossings = 0;
        for (const Edge& start : site.crossed_rows())
            crossings +=
                static_cast<std::size_t>(std::popcount(site.row(start.at(1), start.at(2)).crossed[start.axis()]));
        clouds_.begin(crossings);
        gatherer_.gather(site, clouds_, ligns_);
        return clouds_.finish();
    }

    // Is a disk box of several cells flat enough? The cloud `around` holds its crossings, and may hold others.
    bool passes(const Site& site, const DikePlaces<N>& places, const DyadicBox<N>& box, const Cloud& around) {
        const auto [x, y, z] = box.dikes;
        const Word bit = Word{1} << DikeBits<N>::bit(x);
        if (!(asked_[y][z] & bit)) {
            asked_[y][z] |= bit;
            if (is_flat(site, places, box, around)) passed_[y][z] |= bit;
        }
        return passed_[y][z] & bit;
    }

    // Calls visit(cloud) with a cloud that holds fewer crossings outside the box than `around`, where that pays.
    template <class Visit>
    void with_cloud_of(const DikePlaces<N>& places, const DyadicBox<N>& box, const Cloud& around, const Visit& visit) {
        const std::size_t top = clouds_.top();
        const bool pays = box != DyadicBox<N>::whole() && around.size > kWorthFiltering;
        visit(pays ? clouds_.push(around, places.extent(box)) : around);
        clouds_.pop(top);
    }

  private:
    using Word = typename DikeBits<N>::Word;
    using Table = std::array<std::array<Word, 2 * N>, 2 * N>;  // [y][z], a bit for each dike along x
    static constexpr std::size_t kWorthFiltering = 16;         // crossings around a box

    bool is_flat(const Site& site, const DikePlaces<N>& places, const DyadicBox<N>& box, const Cloud& around) const {
        const HighRice rice = places.high_rice(box);
        const unsigned corners = site.corners(rice);
        const Rim& rim = kRims[corners];
        const EndsByAxis ends = ends_of(rice);
        // A rim has 3 to 6 edges; a loop of always 4 or 6 is mispredicted less often.
        Flatness::Ring ring;
        const std::size_t size = rim.length > 4 ? 6 : 4;
        for (std::size_t n = 0; n < size; ++n) ring[n] = along_edge(ends, kSides[rim.edges[n]]);
        std::fill(ring.begin() + size, ring.end(), ring[0]);
        return flat_(around, places.extent(box), corners, ring);
    }

    // Where the one crossing on an edge of a simple box is along the edge's axis.
    float along_edge(const EndsByAxis& ends, const Side& side) const {
        constexpr std::size_t kSamples = N + 1;
        const std::size_t lign = Ligns::lign(kSamples, side.axis, ends[side.ends[0]], ends[side.ends[1]]);
        const int along = std::countr_zero(ligns_.crossed[lign] & ~std::uint64_t{0} << ends[2u * side.axis]);
        return (static_cast<float>(along) + ligns_.shares[Ligns::edge(kSamples, lign, along)]) *
               gatherer_.scale[side.axis];
    }

    const Gatherer& gatherer_;
    Flatness flat_;
    Ligns ligns_;
    Clouds clouds_;
    Table asked_, passed_;  // boxes for which the answer is known; those of them that are flat enough
};

}  // namespace isocore::climbing
