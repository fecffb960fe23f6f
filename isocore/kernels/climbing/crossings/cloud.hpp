// cloud.hpp - The crossings of a block as points, and the clouds of its boxes, one filtered from the other. All are
// relative to the block and in the unit of the error bound.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <limits>

#include "climbing/vectors.hpp"
#include "common/array.hpp"
#include "common/lanes.hpp"

namespace isocore::climbing {

// A closed box.
struct Extent {
    Spot low, high;
};

// Some spots, axis by axis. What fills up the last lanes is far from every box.
struct Cloud {
    std::array<const float*, 3> axes{};
    std::size_t size = 0, lanes = 0;
};

using Numbers = Lanes<float>;

// The lanes of a cloud from n on that lie in a closed box.
inline Floats::Mask within(const Extent& box, const Numbers& x, const Numbers& y, const Numbers& z) {
    return (Numbers(box.low[0]) <= x) & (x <= box.high[0]) & (Numbers(box.low[1]) <= y) & (y <= box.high[1]) &
           (Numbers(box.low[2]) <= z) & (z <= box.high[2]);
}

// A stack of clouds: of a block, of one of its halves, of one of that one's halves, and so on.
class Clouds {
  public:
    // Room for as many as any block of that size can need is made once: pushing must never move what lies below. Most
    // of it is never touched, and so takes no memory.
    explicit Clouds(int block_size) : block_size_(block_size) {
        numbers_.resize(3 * room(std::numeric_limits<std::size_t>::max()));
    }
    // Goes to a block with so many crossings.
    void begin(std::size_t crossings) {
        start_ = top_ = 0;
        if (crossings < planned_) return;
        constexpr std::size_t kStep = 512;
        planned_ = (crossings / kStep + 1) * kStep;
        const std::size_t each = room(planned_);
        for (std::size_t a = 0; a < 3; ++a) places_[a] = numbers_.data() + a * each;
    }
    // Adds the first `count` lanes.
    void add(const Vector<Numbers>& spots, std::size_t count) {
        for (std::size_t a = 0; a < 3; ++a) spots[a].store(places_[a] + top_);
        top_ += count;
    }
    // Ends the cloud that was added since the last one.
    Cloud finish() {
        Cloud out;
        out.size = top_ - start_;
        for (std::size_t a = 0; a < 3; ++a) out.axes[a] = places_[a] + start_;
        for (float* axis : places_) Numbers(std::numeric_limits<float>::infinity()).store(axis + top_);
        out.lanes = (out.size + kLanes<float> - 1) / kLanes<float> * kLanes<float>;
        start_ = top_ = start_ + out.lanes;
        return out;
    }
    std::size_t top() const { return top_; }
    void pop(std::size_t top) { start_ = top_ = top; }

    // Pushes the points of `from` within a box.
    Cloud push(const Cloud& from, const Extent& box) {
        for (std::size_t n = 0; n < from.lanes; n += kLanes<float>) {
            const Numbers x(from.axes[0] + n), y(from.axes[1] + n), z(from.axes[2] + n);
            const unsigned here = within(box, x, y, z).bits();
            x.pack(here, places_[0] + top_);
            y.pack(here, places_[1] + top_);
            z.pack(here, places_[2] + top_);
            top_ += static_cast<std::size_t>(std::popcount(here));
        }
        return finish();
    }

  private:
    // For so many crossings of a block, or all of its edges, and for one half after the other, however it is halved.
    std::size_t room(std::size_t crossings) const {
        constexpr std::size_t kMost = 6;  // lengths are 1, 2, 4, ... 32
        const auto within = [&](std::size_t a, std::size_t b, std::size_t c) {
            return std::min(crossings, a * (b + 1) * (c + 1) + b * (c + 1) * (a + 1) + c * (a + 1) * (b + 1)) +
                   2 * kLanes<float>;
        };
        std::array<std::array<std::array<std::size_t, kMost>, kMost>, kMost> rooms;
        for (std::size_t x = 0; x < kMost; ++x) {
            for (std::size_t y = 0; y < kMost; ++y) {
                for (std::size_t z = 0; z < kMost; ++z) {
                    const std::size_t half = std::max({x > 0 ? rooms[x - 1][y][z] : 0, y > 0 ? rooms[x][y - 1][z] : 0,
                                                       z > 0 ? rooms[x][y][z - 1] : 0});
                    rooms[x][y][z] = within(std::size_t{1} << x, std::size_t{1} << y, std::size_t{1} << z) + half;
                }
            }
        }
        const auto depth = static_cast<std::size_t>(std::countr_zero(static_cast<unsigned>(block_size_)));
        return rooms[depth][depth][depth];
    }

    int block_size_;
    Array<float> numbers_;
    std::size_t planned_ = 0;         // no block has as many crossings
    std::array<float*, 3> places_{};  // within the numbers
    std::size_t start_ = 0, top_ = 0;
};

}  // namespace isocore::climbing
