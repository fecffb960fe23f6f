// signs.hpp - The sign of every sample as one bit: what the marching and climbing kernels really run on.
// Sample (i, j, k) is bit i % 64 of word i / 64 of row (j, k); bits past the end of a row are 0. A padded grid
// has one more layer of outside samples on every side, which closes the surface at the border: its sample
// (i, j, k) is the volume's (i - 1, j - 1, k - 1).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "common/array.hpp"
#include "common/bit_fields.hpp"
#include "common/grid.hpp"

namespace isocore {

struct SignGrid {
    Dims dims;          // samples per axis, padding included
    std::size_t pad;    // 0 or 1
    std::size_t words;  // per row
    Array<std::uint64_t> bits;  // and a word more, so that what follows a row's last word may be read

    const std::uint64_t* row(std::size_t j, std::size_t k) const { return bits.data() + words * (j + dims[1] * k); }
    bool at(std::size_t i, std::size_t j, std::size_t k) const { return row(j, k)[i / 64] >> (i % 64) & 1; }
    // Which bits of word w belong to samples (or, with cells = 1, to cells) of a row.
    std::uint64_t valid(std::size_t w, std::size_t cells = 0) const {
        const std::size_t count = dims[0] - cells, before = std::min(count, 64 * w);
        return lowest_bits(std::min<std::size_t>(count - before, 64));
    }
};

// Instantiated in signs.cpp for the eight sample types. `below`: inside is sample <= isovalue. With the `ranges` that
// sample_ranges() gave, the samples of blocks that lie on one side are not read.
template <class Sample>
SignGrid classify(GridView<Sample> samples, double isovalue, bool below, bool padded, int threads, const Sample* ranges = nullptr);

// The row's samples from i on, as far as a word goes. What is beyond the row's last sample tells nothing.
inline std::uint64_t samples_from(const std::uint64_t* row, std::size_t i) {
    return row[i / 64] >> i % 64 | row[i / 64 + 1] << 1 << (63 - i % 64);
}

// The row moved by one sample towards 0, so that bit i tells of sample i + 1. What is beyond the row's last sample tells
// nothing.
inline std::uint64_t next_samples(const std::uint64_t* row, std::size_t w) { return row[w] >> 1 | row[w + 1] << 63; }

}  // namespace isocore
