#include "climbing/crossings/cloud.hpp"

#include <algorithm>
#include <bit>
#include <limits>

namespace isocore::climbing {

Clouds::Clouds(int block_size) : block_size_(block_size) {
    numbers_.resize(3 * room(std::numeric_limits<std::size_t>::max()));
}

// The three axes are put no further apart than `crossings` asks for, so that few pages are touched.
void Clouds::begin(std::size_t crossings) {
    start_ = top_ = 0;
    if (crossings < planned_) return;
    constexpr std::size_t kStep = 512;
    planned_ = (crossings / kStep + 1) * kStep;
    const std::size_t each = room(planned_);
    for (std::size_t a = 0; a < 3; ++a) places_[a] = numbers_.data() + a * each;
}

Cloud Clouds::finish() {
    Cloud out;
    out.size = top_ - start_;
    for (std::size_t a = 0; a < 3; ++a) out.axes[a] = places_[a] + start_;
    for (float* axis : places_) Floats(std::numeric_limits<float>::infinity()).store(axis + top_);
    out.lanes = (out.size + kLanes - 1) / kLanes * kLanes;
    start_ = top_ = start_ + out.lanes;
    return out;
}

Cloud Clouds::push(const Cloud& from, const Extent& box) {
    for (std::size_t n = 0; n < from.lanes; n += kLanes) {
        const Floats x(from.axes[0] + n), y(from.axes[1] + n), z(from.axes[2] + n);
        const unsigned here = within(box, x, y, z).bits();
        x.pack(here, places_[0] + top_);
        y.pack(here, places_[1] + top_);
        z.pack(here, places_[2] + top_);
        top_ += static_cast<std::size_t>(std::popcount(here));
    }
    return finish();
}

// The numbers per axis that the deepest stack of a block with at most that many crossings takes, however it is halved:
// for each box, as many as it has grid edges or the block has crossings, and then the stack of one of its halves.
std::size_t Clouds::room(std::size_t crossings) const {
    constexpr std::size_t kMost = 6;  // lengths 1, 2, 4, ... 32
    const auto of_box = [&](std::size_t a, std::size_t b, std::size_t c) {
        return std::min(crossings, a * (b + 1) * (c + 1) + b * (c + 1) * (a + 1) + c * (a + 1) * (b + 1)) + 2 * kLanes;
    };
    std::array<std::array<std::array<std::size_t, kMost>, kMost>, kMost> rooms;  // by the logarithms of the lengths
    for (std::size_t x = 0; x < kMost; ++x) {
        for (std::size_t y = 0; y < kMost; ++y) {
            for (std::size_t z = 0; z < kMost; ++z) {
                const std::size_t half = std::max(
                    {x > 0 ? rooms[x - 1][y][z] : 0, y > 0 ? rooms[x][y - 1][z] : 0, z > 0 ? rooms[x][y][z - 1] : 0});
                rooms[x][y][z] = of_box(std::size_t{1} << x, std::size_t{1} << y, std::size_t{1} << z) + half;
            }
        }
    }
    const auto depth = static_cast<std::size_t>(std::countr_zero(static_cast<unsigned>(block_size_)));
    return rooms[depth][depth][depth];
}

}  // namespace isocore::climbing
