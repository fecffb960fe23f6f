// statistics.hpp - What an isovalue is chosen from: the range of the samples and how they are spread.
// samples: any order, one of the eight sample types. All functions give the same result for any number of threads.
//
// extent: smallest and largest finite sample, and how many are not finite. Without a finite sample,
// minimum > maximum.
//
// extent_between: smallest and largest of the samples from low to high, both included, and how many they are.
// Without one, infinity and -infinity.
//
// histogram: counts of the samples in `bins` equal bins from low to high, both ends included; samples outside
// and non-finite ones are left out. With integers and bins = high - low + 1 every bin is one exact value.
// Throws std::invalid_argument unless low <= high and bins > 0.
#pragma once

#include <cstddef>
#include <cstdint>

#include "common/array.hpp"

namespace isocore {

struct Extent {
    double minimum;
    double maximum;
    std::size_t nonfinite;
};

struct Within {
    double minimum;
    double maximum;
    std::size_t count;
};

template <class Sample>
Extent extent(const Sample* samples, std::size_t count, int threads);

template <class Sample>
Within extent_between(const Sample* samples, std::size_t count, double low, double high, int threads);

template <class Sample>
Array<std::uint64_t> histogram(const Sample* samples, std::size_t count, double low, double high, std::size_t bins,
                               int threads);

}  // namespace isocore
