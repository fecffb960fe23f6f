// sample_ranges.cpp - One pass over the volume, at the speed of memory.
#include "samples/sample_ranges.hpp"

#include <algorithm>
#include <limits>

#include "common/parallel.hpp"
#include "samples/sample_types.hpp"

namespace isocore {
namespace {

// Sixteen independent minima and maxima. A single running minimum would be a chain in which every comparison waits for
// the one before, and which compilers may not reorder where samples can be NaN.
template <class Sample>
class Range {
  public:
    Range() {
        std::fill_n(lowest_, kLanes, std::numeric_limits<Sample>::max());
        std::fill_n(highest_, kLanes, std::numeric_limits<Sample>::lowest());
    }

    void add(const Sample* samples, std::size_t count) {
        std::size_t n = 0;
        for (; n + kLanes <= count; n += kLanes) {
            for (std::size_t lane = 0; lane < kLanes; ++lane) add(samples[n + lane], lane);
        }
        for (; n < count; ++n) add(samples[n], 0);
    }

    Sample lowest() const {
        return has_nan() ? -std::numeric_limits<Sample>::infinity() : *std::min_element(lowest_, lowest_ + kLanes);
    }
    Sample highest() const {
        return has_nan() ? std::numeric_limits<Sample>::infinity() : *std::max_element(highest_, highest_ + kLanes);
    }

  private:
    static constexpr std::size_t kLanes = 16;

    void add(Sample sample, std::size_t lane) {
        lowest_[lane] = sample < lowest_[lane] ? sample : lowest_[lane];
        highest_[lane] = sample > highest_[lane] ? sample : highest_[lane];
        has_nan_[lane] |= sample != sample;
    }
    bool has_nan() const {
        return std::any_of(has_nan_, has_nan_ + kLanes, [](int lane) { return lane != 0; });
    }

    Sample lowest_[kLanes], highest_[kLanes];
    int has_nan_[kLanes] = {};
};

}  // namespace

template <class Sample>
Array<Sample> sample_ranges(GridView<Sample> samples, int threads) {
    const Dims& dims = samples.dims;
    Array<Sample> out(range_count(dims));
    const std::size_t layers = (dims[2] - 1) / kRangeBlock[2] + 1;
    parallel_for(threads, layers, [&](std::size_t layer) {
        const std::size_t k0 = layer * kRangeBlock[2], k1 = std::min(k0 + kRangeBlock[2], dims[2]);
        for (std::size_t j0 = 0; j0 < dims[1]; j0 += kRangeBlock[1]) {
            for (std::size_t i0 = 0; i0 < dims[0]; i0 += kRangeBlock[0]) {
                Range<Sample> range;
                for (std::size_t k = k0; k < k1; ++k) {
                    for (std::size_t j = j0; j < std::min(j0 + kRangeBlock[1], dims[1]); ++j) {
                        range.add(samples.row(j, k) + i0, std::min(kRangeBlock[0], dims[0] - i0));
                    }
                }
                Sample* block = out.data() + 2 * range_block(dims, i0, j0, k0);
                block[0] = range.lowest();
                block[1] = range.highest();
            }
        }
    });
    return out;
}

#define ISOCORE_INSTANTIATE(Sample) template Array<Sample> sample_ranges<Sample>(GridView<Sample>, int);
ISOCORE_FOR_EACH_SAMPLE_TYPE(ISOCORE_INSTANTIATE)
#undef ISOCORE_INSTANTIATE

}  // namespace isocore
