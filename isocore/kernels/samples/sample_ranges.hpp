// sample_ranges.hpp - The smallest and the largest sample of every block, so that a further isovalue reads only the
// blocks that it crosses. Blocks are as wide as a word of signs.
#pragma once

#include <cstddef>

#include "common/array.hpp"
#include "common/grid.hpp"

namespace isocore {

inline constexpr Dims kRangeBlock{64, 16, 16};

// The number of the block that sample (i, j, k) lies in.
inline std::size_t range_block(const Dims& dims, std::size_t i, std::size_t j, std::size_t k) {
    const auto blocks = [&](std::size_t axis) { return (dims[axis] - 1) / kRangeBlock[axis] + 1; };
    return i / kRangeBlock[0] + blocks(0) * (j / kRangeBlock[1] + blocks(1) * (k / kRangeBlock[2]));
}

// How many numbers sample_ranges() gives.
inline std::size_t range_count(const Dims& dims) {
    return 2 * (range_block(dims, dims[0] - 1, dims[1] - 1, dims[2] - 1) + 1);
}

// Two numbers per block, its lowest and its highest sample. A block with a NaN gets -infinity and infinity.
template <class Sample>
Array<Sample> sample_ranges(GridView<Sample> samples, int threads);

}  // namespace isocore
