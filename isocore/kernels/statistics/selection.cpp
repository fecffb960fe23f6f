// selection.cpp - Selection by digits of the sample's bits: count the highest 16, keep the bucket that holds the rank,
// count the next 16 of what is in it, and so on. A bucket is narrow where the samples are small and wide where they
// are large, so that no outlier and no fill value spoils it; after the last digits it holds one value.
#include "statistics/selection.hpp"

#include <algorithm>
#include <bit>
#include <limits>
#include <stdexcept>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/crossing.hpp"
#include "samples/sample_types.hpp"
#include "statistics/chunks.hpp"

namespace isocore {
namespace {

template <std::size_t kBytes>
using Unsigned = std::conditional_t<
    kBytes == 8, std::uint64_t,
    std::conditional_t<kBytes == 4, std::uint32_t, std::conditional_t<kBytes == 2, std::uint16_t, std::uint8_t>>>;

// Bits as an unsigned number in the order of the samples: the sign turned over, and with it all bits below it of a
// negative floating-point number.
template <class Sample>
struct Key {
    using Type = Unsigned<sizeof(Sample)>;
    static constexpr int kBits = 8 * sizeof(Sample);
    static constexpr Type kSign = Type{1} << (kBits - 1);

    static Type of(Sample sample) {
        if constexpr (std::is_floating_point_v<Sample>) {
            const Type bits = std::bit_cast<Type>(sample + Sample{0});  // -0 becomes 0, which it equals
            return bits & kSign ? static_cast<Type>(~bits) : static_cast<Type>(bits | kSign);
        } else if constexpr (std::is_signed_v<Sample>) {
            return static_cast<Type>(static_cast<Type>(sample) ^ kSign);
        } else {
            return sample;
        }
    }

    static Sample sample(Type key) {
        if constexpr (std::is_floating_point_v<Sample>) {
            return std::bit_cast<Sample>(key & kSign ? static_cast<Type>(key ^ kSign) : static_cast<Type>(~key));
        } else if constexpr (std::is_signed_v<Sample>) {
            return static_cast<Sample>(static_cast<Type>(key ^ kSign));
        } else {
            return key;
        }
    }
};

constexpr std::size_t kBuckets = 65536;

// Adds the digits of one chunk to `counts`, for keys from `lowest` on that are at most `reach` above it. The keys of a
// bucket are such a range too. Two tables in turn: a run of equal samples would wait for the store of one counter.
template <class Sample>
void count_digits(const Sample* samples, std::size_t count, typename Key<Sample>::Type lowest,
                  typename Key<Sample>::Type reach, int shift, std::vector<std::uint64_t>& counts) {
    using Type = typename Key<Sample>::Type;
    std::vector<std::uint64_t> other(kBuckets, 0);
    const auto add = [&](std::vector<std::uint64_t>& table, Sample sample) {
        const Type key = Key<Sample>::of(sample);
        if (static_cast<Type>(key - lowest) > reach) return;
        ++table[static_cast<std::size_t>(key >> shift) % kBuckets];
    };
    std::size_t i = 0;
    for (; i + 2 <= count; i += 2) {
        add(counts, samples[i]);
        add(other, samples[i + 1]);
    }
    if (i < count) add(counts, samples[i]);
    for (std::size_t bucket = 0; bucket < kBuckets; ++bucket) counts[bucket] += other[bucket];
}

template <class Sample>
std::vector<std::uint64_t> counts_of(const Sample* samples, std::size_t count, typename Key<Sample>::Type lowest,
                                     typename Key<Sample>::Type reach, int shift, int threads) {
    const std::size_t chunks = chunk_count(count, threads);
    std::vector<std::vector<std::uint64_t>> parts(chunks);
    over_chunks(count, chunks, threads, [&](std::size_t chunk, std::size_t first, std::size_t last) {
        parts[chunk].assign(kBuckets, 0);
        count_digits(samples + first, last - first, lowest, reach, shift, parts[chunk]);
    });
    for (std::size_t chunk = 1; chunk < chunks; ++chunk) {
        for (std::size_t bucket = 0; bucket < kBuckets; ++bucket) parts[0][bucket] += parts[chunk][bucket];
    }
    return std::move(parts[0]);
}

}  // namespace

template <class Sample>
Ranked sample_of_rank(const Sample* samples, std::size_t count, double low, double high, std::uint64_t rank,
                      int threads) {
    using Type = typename Key<Sample>::Type;
    const Inside<Sample> from(low, false), to(high, true);
    const std::invalid_argument too_few("a rank needs more samples than it says from low to high");
    if (!(low <= high) || from.nothing || to.nothing || from.lowest > to.highest) throw too_few;
    Type lowest = Key<Sample>::of(from.lowest), highest = Key<Sample>::of(to.highest);
    std::uint64_t below = 0;
    for (int shift = Key<Sample>::kBits > 16 ? Key<Sample>::kBits - 16 : 0;; shift -= 16) {
        const auto counts = counts_of(samples, count, lowest, static_cast<Type>(highest - lowest), shift, threads);
        // From the second round on, the digits above these are alike in the whole range.
        std::size_t bucket = static_cast<std::size_t>(lowest >> shift) % kBuckets;
        const std::size_t last = static_cast<std::size_t>(highest >> shift) % kBuckets;
        for (; bucket <= last && below + counts[bucket] <= rank; ++bucket) below += counts[bucket];
        if (bucket > last) throw too_few;
        const Type prefix = static_cast<Type>(((lowest >> shift) & ~std::size_t{0xFFFF}) | bucket);
        if (shift == 0) return {static_cast<double>(Key<Sample>::sample(prefix)), below, counts[bucket]};
        const Type first = static_cast<Type>(prefix << shift);
        const Type end = static_cast<Type>(first | static_cast<Type>((Type{1} << shift) - 1));
        lowest = std::max(lowest, first);
        highest = std::min(highest, end);
    }
}

#define ISOCORE_SELECTION(Sample) \
    template Ranked sample_of_rank(const Sample*, std::size_t, double, double, std::uint64_t, int);
ISOCORE_FOR_EACH_SAMPLE_TYPE(ISOCORE_SELECTION)
#undef ISOCORE_SELECTION

}  // namespace isocore
