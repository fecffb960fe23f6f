// range_lookup.hpp - Which intervals hold a value? Intervals sorted by their low end, and above them the highest high
// end of every 16, of every 256 and so on: a query walks down only where it finds something, O(log n + hits).
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace isocore::thinning {

class RangeLookup {
  public:
    // low is ascending; an interval holds v iff low < v <= high.
    RangeLookup(const double* low, const double* high, std::size_t size) : low_(low), high_(high), size_(size) {
        for (std::size_t count = size; count > kFan; count = highest_.back().size()) {
            const double* below = highest_.empty() ? high : highest_.back().data();
            std::vector<double> level((count + kFan - 1) / kFan);
            for (std::size_t n = 0; n < level.size(); ++n)
                level[n] = *std::max_element(below + kFan * n, below + std::min(count, kFan * (n + 1)));
            highest_.push_back(std::move(level));
        }
    }

    // Calls hit(n) for every interval n that holds the value, ascending.
    template <class Hit>
    void find(double value, const Hit& hit) const {
        const auto end = static_cast<std::size_t>(std::lower_bound(low_, low_ + size_, value) - low_);
        descend(highest_.size(), 0, end, value, hit);
    }

  private:
    static constexpr std::size_t kFan = 16;

    // Looks at the blocks of a level from `first` on, as far as they begin before `end` (in intervals).
    template <class Hit>
    void descend(std::size_t level, std::size_t first, std::size_t end, double value, const Hit& hit) const {
        const std::size_t width = level == 0 ? 1 : std::size_t{1} << 4 * level;
        for (std::size_t n = first; n < first + kFan && n * width < end; ++n) {
            const double highest = level == 0 ? high_[n] : highest_[level - 1][n];
            if (highest < value) continue;
            if (level == 0)
                hit(n);
            else
                descend(level - 1, n * kFan, end, value, hit);
        }
    }

    const double *low_, *high_;
    std::size_t size_;
    std::vector<std::vector<double>> highest_;
};

}  // namespace isocore::thinning
