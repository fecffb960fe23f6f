// signs.hpp - The sign of every sample as one bit: what the marching and climbing kernels really run on.
// Sample (i, j, k) is bit i % 8 of byte i / 8 of row (j, k). Rows are rounded to whole bytes and no more, as signs are
// most of what a kernel needs beyond the volume and the surface; words of 64 are read from any byte on. A padded grid
// has one more layer of outside samples on every side, which closes the surface at the border: its sample (i, j, k) is
// the volume's (i - 1, j - 1, k - 1).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "common/array.hpp"
#include "common/bit_fields.hpp"
#include "common/grid.hpp"

namespace isocore {

// One row of signs. The bits beyond its last sample are undefined.
class SignRow {
  public:
    explicit SignRow(const std::uint8_t* bytes) : bytes_(bytes) {}

    // Samples 64 w to 64 w + 63.
    std::uint64_t word(std::size_t w) const { return load_bits(bytes_ + 8 * w); }
    // Samples 64 w + 1 to 64 w + 64: bit i is the next sample's after bit i of word(w).
    std::uint64_t next_word(std::size_t w) const { return word(w) >> 1 | std::uint64_t{bytes_[8 * w + 8]} << 63; }
    // Sample i as bit 0, and those after it: at least 57 in all.
    std::uint64_t from(std::size_t i) const { return load_bits(bytes_ + i / 8) >> i % 8; }
    bool at(std::size_t i) const { return bytes_[i / 8] >> i % 8 & 1; }

  private:
    const std::uint8_t* bytes_;
};

struct SignGrid {
    static constexpr std::size_t kBeyond = 16;  // bytes that may be read after the last row

    Dims dims;                  // samples per axis, padding included
    std::size_t pad;            // 0 or 1
    std::size_t stride, words;  // per row: bytes, and the words of 64 signs that cover it
    Array<std::uint8_t> bytes;

    SignRow row(std::size_t j, std::size_t k) const { return SignRow(bytes.data() + stride * (j + dims[1] * k)); }
    bool at(std::size_t i, std::size_t j, std::size_t k) const { return row(j, k).at(i); }
    // Which bits of word w belong to samples (or, with cells = 1, to cells) of a row.
    std::uint64_t valid(std::size_t w, std::size_t cells = 0) const {
        const std::size_t count = dims[0] - cells, before = std::min(count, 64 * w);
        return lowest_bits(std::min<std::size_t>(count - before, 64));
    }
};

// Instantiated in signs.cpp for the eight sample types. `below`: inside is sample <= isovalue. With the `ranges` that
// sample_ranges() gave, the samples of blocks that lie on one side are not read.
template <class Sample>
SignGrid classify(GridView<Sample> samples, double isovalue, bool below, bool padded, int threads,
                  const Sample* ranges = nullptr);

}  // namespace isocore
