// dyadic_box.hpp - A box of a block as the labels of its dikes along x, y and z: what a partition halves. (README.md
// lists the other shapes that a box has.)
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "climbing/boxes/dike.hpp"
#include "climbing/crossings/cloud.hpp"
#include "climbing/high_rice.hpp"

namespace isocore::climbing {

template <int N>
struct DyadicBox {
    std::array<Label, 3> dikes;

    static constexpr DyadicBox whole() { return {{1, 1, 1}}; }
    bool operator==(const DyadicBox&) const = default;

    bool is_cell() const { return Dike<N>::is_unit(std::min({dikes[0], dikes[1], dikes[2]})); }
    int cells() const { return Dike<N>::length(dikes[0]) * Dike<N>::length(dikes[1]) * Dike<N>::length(dikes[2]); }
    bool can_be_halved(std::size_t axis) const { return !Dike<N>::is_unit(dikes[axis]); }
    // The axes along which it can be halved, a bit each.
    unsigned axes() const {
        const auto bit = [&](unsigned axis) { return unsigned{can_be_halved(axis)} << axis; };
        return bit(0) | bit(1) | bit(2);
    }
    // Its lower and its upper half along an axis along which it can be halved.
    std::array<DyadicBox, 2> halves(std::size_t axis) const {
        std::array<DyadicBox, 2> out{*this, *this};
        out[0].dikes[axis] = 2 * dikes[axis];
        out[1].dikes[axis] = 2 * dikes[axis] + 1;
        return out;
    }
};

// Where the dikes of a block lie, as far as they do in the volume.
template <int N>
class DikePlaces {
  public:
    // For a block that has `cells` cells along each axis before the volume's end; `scale` is from samples to the unit
    // of extents. Does nothing along axes along which the last block had as many: nearly all blocks are whole.
    void measure(const std::array<int, 3>& cells, const Spot& scale) {
        for (std::size_t a = 0; a < 3; ++a) {
            if (measured_[a] == cells[a]) continue;
            measured_[a] = cells[a];
            for (Label label = 1; label < 2 * N; ++label) {
                const int low = Dike<N>::start(label), high = std::min(Dike<N>::end(label), measured_[a]);
                places_[a][label] = {static_cast<std::uint8_t>(low), static_cast<std::uint8_t>(high),
                                     static_cast<float>(low) * scale[a], static_cast<float>(high) * scale[a]};
            }
        }
    }

    Extent extent(const DyadicBox<N>& box) const {
        const auto& [x, y, z] = of(box);
        return {{x.from, y.from, z.from}, {x.to, y.to, z.to}};
    }
    HighRice high_rice(const DyadicBox<N>& box) const {
        const auto& [x, y, z] = of(box);
        return {{x.low, y.low, z.low}, {x.high, y.high, z.high}};
    }

  private:
    // A dike in samples from the block's origin, and in the unit of extents.
    struct Segment {
        std::uint8_t low, high;
        float from, to;
    };
    struct Segments {
        const Segment &x, &y, &z;
    };
    Segments of(const DyadicBox<N>& box) const {
        return {places_[0][box.dikes[0]], places_[1][box.dikes[1]], places_[2][box.dikes[2]]};
    }

    std::array<int, 3> measured_{};  // cells along each axis; 0 before the first block
    std::array<std::array<Segment, 2 * N>, 3> places_;
};

}  // namespace isocore::climbing
