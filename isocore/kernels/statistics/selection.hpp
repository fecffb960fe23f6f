// selection.hpp - The sample of a given rank, exactly, whatever the range of the samples and however they are spread.
// samples: any order, one of the eight sample types. low, high: only samples from low to high count, both included;
// NaN never does. Same result for any number of threads; memory does not grow with the samples.
// Throws std::invalid_argument unless more than `rank` samples lie from low to high.
#pragma once

#include <cstddef>
#include <cstdint>

namespace isocore {

// value: the sample that has `rank` others before it in sorted order; below: how many are smaller than it;
// equal: how many are like it, itself included.
struct Ranked {
    double value;
    std::uint64_t below;
    std::uint64_t equal;
};

template <class Sample>
Ranked sample_of_rank(const Sample* samples, std::size_t count, double low, double high, std::uint64_t rank,
                      int threads);

}  // namespace isocore
