// cloud.hpp - The crossings of a block as points, and the clouds of its boxes, one filtered from the other.
#pragma once

#include <array>
#include <cstddef>

#include "common/array.hpp"

namespace isocore::climbing {

// In samples from the block's origin.
struct Cloud {
    const float *x, *y, *z;
    std::size_t size;
};

// A stack of clouds. Room for all levels of a block is made once, so that pushing never moves what lies below.
class Clouds {
  public:
    // Forgets everything and makes room for `levels` clouds of at most `size` points.
    void reset(std::size_t size, std::size_t levels) {
        for (auto& axis : places_) axis.resize(size * levels);
        top_ = 0;
    }
    void add(float x, float y, float z) {
        places_[0][top_] = x;
        places_[1][top_] = y;
        places_[2][top_++] = z;
    }
    std::size_t top() const { return top_; }
    void pop(std::size_t top) { top_ = top; }
    Cloud since(std::size_t start) const {
        return {places_[0].data() + start, places_[1].data() + start, places_[2].data() + start, top_ - start};
    }

    // Pushes the points of `from` within a closed box.
    Cloud within(const Cloud& from, const std::array<float, 3>& low, const std::array<float, 3>& high) {
        const std::size_t start = top_;
        float *x = places_[0].data(), *y = places_[1].data(), *z = places_[2].data();
        std::size_t next = top_;
        for (std::size_t n = 0; n < from.size; ++n) {
            x[next] = from.x[n];
            y[next] = from.y[n];
            z[next] = from.z[n];
            next += static_cast<std::size_t>((from.x[n] >= low[0]) & (from.x[n] <= high[0]) & (from.y[n] >= low[1]) &
                                             (from.y[n] <= high[1]) & (from.z[n] >= low[2]) & (from.z[n] <= high[2]));
        }
        top_ = next;
        return since(start);
    }

  private:
    std::array<Array<float>, 3> places_;
    std::size_t top_ = 0;
};

}  // namespace isocore::climbing
