// cloud.hpp - The crossings of a block as points, and the clouds of its boxes, each filtered from that of the box it is
// a half of. All are relative to the block's origin and in the unit of the error bound (gatherer.hpp).
#pragma once

#include <array>
#include <cstddef>

#include "common/array.hpp"
#include "common/lanes.hpp"
#include "common/vectors.hpp"

namespace isocore::climbing {

// A closed box.
struct Extent {
    Spot low, high;
};

// Some spots, one array of `size` numbers per axis. Arrays go on to `lanes` numbers, the next multiple of a register's
// lanes; spots past `size` lie infinitely far away, so in no box.
struct Cloud {
    std::array<const float*, 3> axes{};
    std::size_t size = 0, lanes = 0;
};

// Which of eight spots lie in a closed box.
inline Floats::Mask within(const Extent& box, const Floats& x, const Floats& y, const Floats& z) {
    return (Floats(box.low[0]) <= x) & (x <= box.high[0]) & (Floats(box.low[1]) <= y) & (y <= box.high[1]) &
           (Floats(box.low[2]) <= z) & (z <= box.high[2]);
}

// A stack of clouds: that of a block, that of one of its halves, that of one of the half's halves, and so on.
class Clouds {
  public:
    // Memory is taken once, for the deepest stack that any block of this size can need, as pushing must never move the
    // clouds below. Most of it is never touched, and so is never given a page by the system.
    explicit Clouds(int block_size);

    // Forgets all clouds, for a block with that many crossings; they are then added, and finish() makes them a cloud.
    void begin(std::size_t crossings);
    // Adds the first `count` lanes of some spots to the cloud at the top, which is not finished yet.
    void add(const Vector<Floats>& spots, std::size_t count) {
        for (std::size_t a = 0; a < 3; ++a) spots[a].store(places_[a] + top_);
        top_ += count;
    }
    Cloud finish();

    // Pushes the cloud of those spots of `from` that lie in a box.
    Cloud push(const Cloud& from, const Extent& box);
    // Where the stack ends, and back to there.
    std::size_t top() const { return top_; }
    void pop(std::size_t top) { start_ = top_ = top; }

  private:
    std::size_t room(std::size_t crossings) const;

    int block_size_;
    Array<float> numbers_;
    std::size_t planned_ = 0;         // every block so far has had fewer crossings than this
    std::array<float*, 3> places_{};  // where each axis starts within the numbers
    std::size_t start_ = 0, top_ = 0;
};

}  // namespace isocore::climbing
