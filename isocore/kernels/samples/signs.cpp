// signs.cpp - Classification at the speed of memory: compare 64 samples into 64 bytes, gather their top bits.
#include "samples/signs.hpp"

#include <algorithm>
#include <cstring>
#include <vector>

#include "common/crossing.hpp"
#include "common/parallel.hpp"
#include "samples/sample_ranges.hpp"
#include "samples/sample_types.hpp"

#if defined(__AVX2__)
#include <immintrin.h>
#elif defined(__SSE2__) || defined(_M_X64)
#include <emmintrin.h>
#endif

namespace isocore {
namespace {

// Bit n of the result is the top bit of flags[n].
std::uint64_t gather(const std::uint8_t* flags) {
#if defined(__AVX2__)
    const auto half = [&](int n) {
        const auto loaded = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(flags + 32 * n));
        return static_cast<std::uint64_t>(static_cast<std::uint32_t>(_mm256_movemask_epi8(loaded)));
    };
    return half(0) | half(1) << 32;
#elif defined(__SSE2__) || defined(_M_X64)
    const auto quarter = [&](int n) {
        const auto loaded = _mm_loadu_si128(reinterpret_cast<const __m128i*>(flags + 16 * n));
        return static_cast<std::uint64_t>(static_cast<std::uint32_t>(_mm_movemask_epi8(loaded)));
    };
    return quarter(0) | quarter(1) << 16 | quarter(2) << 32 | quarter(3) << 48;
#else
    std::uint64_t word = 0;
    for (int n = 0; n < 64; ++n) word |= static_cast<std::uint64_t>(flags[n] >> 7) << n;
    return word;
#endif
}

// A function of its own with restricted pointers (no aliasing): without them some compilers do not vectorise it.
template <class Sample>
void compare(const Sample* __restrict samples, std::uint8_t* __restrict flags, Sample lowest, Sample highest) {
    for (int n = 0; n < 64; ++n) {
        flags[n] = static_cast<std::uint8_t>(-static_cast<int>((samples[n] >= lowest) & (samples[n] <= highest)));
    }
}

template <class Sample>
void classify_row(const Sample* samples, std::size_t count, const Inside<Sample>& inside, std::uint64_t* words) {
    alignas(64) std::uint8_t flags[64];
    std::size_t i = 0;
    for (; i + 64 <= count; i += 64) {
        compare(samples + i, flags, inside.lowest, inside.highest);
        words[i / 64] = gather(flags);
    }
    if (i < count) {
        Sample last[64] = {};
        std::copy(samples + i, samples + count, last);
        compare(last, flags, inside.lowest, inside.highest);
        words[i / 64] = gather(flags) & ((std::uint64_t{1} << (count - i)) - 1);
    }
}

// The same, but where a block's range lies on one side of the isovalue its word is known without reading its samples.
template <class Sample>
void classify_row(const Sample* samples, std::size_t count, const Inside<Sample>& inside, const Sample* ranges,
                  std::uint64_t* words) {
    for (std::size_t i = 0; i < count; i += 64, ranges += 2) {
        const std::size_t here = std::min<std::size_t>(64, count - i);
        const Sample lowest = ranges[0], highest = ranges[1];
        if (lowest > inside.highest || highest < inside.lowest)
            words[i / 64] = 0;
        else if (lowest >= inside.lowest && highest <= inside.highest)
            words[i / 64] = ~std::uint64_t{0} >> (64 - here);
        else
            classify_row(samples + i, here, inside, words + i / 64);
    }
}

// Make room for the layer of outside samples before the row, and one after it.
void shift_by_one(std::uint64_t* row, std::size_t samples, std::size_t words) {
    for (std::size_t w = (samples + 63) / 64; w < words; ++w) row[w] = 0;
    for (std::size_t w = words; w-- > 1;) row[w] = row[w] << 1 | row[w - 1] >> 63;
    row[0] <<= 1;
}

}  // namespace

template <class Sample>
SignGrid classify(GridView<Sample> samples, double isovalue, bool below, bool padded, int threads,
                  const Sample* ranges) {
    const std::size_t pad = padded ? 1 : 0;
    const Dims dims{samples.dims[0] + 2 * pad, samples.dims[1] + 2 * pad, samples.dims[2] + 2 * pad};
    SignGrid grid{dims, pad, (dims[0] + 7) / 8, (dims[0] + 63) / 64, {}};
    grid.bytes.resize(grid.stride * dims[1] * dims[2] + SignGrid::kBeyond);
    std::fill(grid.bytes.end() - SignGrid::kBeyond, grid.bytes.end(), 0);
    const Inside<Sample> inside(isovalue, below);
    const std::size_t plane = grid.stride * dims[1];
    if (inside.nothing) {
        std::fill(grid.bytes.begin(), grid.bytes.end(), 0);
        return grid;
    }
    const auto make = [&] { return std::vector<std::uint64_t>(grid.words); };
    parallel_for(threads, dims[2], make, [&](std::vector<std::uint64_t>& row, std::size_t k) {
        std::uint8_t* rows = grid.bytes.data() + plane * k;
        if (pad) std::fill(rows, rows + plane, 0);
        if (pad && (k == 0 || k + 1 == dims[2])) return;
        for (std::size_t j = 0; j < samples.dims[1]; ++j) {
            const Sample* from = samples.row(j, k - pad);
            if (ranges)
                classify_row(from, samples.dims[0], inside, ranges + 2 * range_block(samples.dims, 0, j, k - pad),
                             row.data());
            else
                classify_row(from, samples.dims[0], inside, row.data());
            if (pad) shift_by_one(row.data(), samples.dims[0], grid.words);
            std::uint8_t* const out = rows + grid.stride * (j + pad);
            store_bits(row.data(), out, grid.stride);
        }
    });
    return grid;
}

#define ISOCORE_INSTANTIATE(Sample) \
    template SignGrid classify<Sample>(GridView<Sample>, double, bool, bool, int, const Sample*);
ISOCORE_FOR_EACH_SAMPLE_TYPE(ISOCORE_INSTANTIATE)
#undef ISOCORE_INSTANTIATE

}  // namespace isocore
