// statistics.cpp - Range and histogram of the samples, at memory speed where the type allows.
#include "statistics/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <type_traits>
#include <vector>

#include "samples/sample_types.hpp"
#include "statistics/chunks.hpp"

namespace isocore {
namespace {

constexpr std::size_t kLanes = 32;

// Lanes instead of one running minimum: independent columns that a compiler turns into vectors.
template <class Sample>
Extent extent_of_chunk(const Sample* __restrict samples, std::size_t count) {
    using Limits = std::numeric_limits<Sample>;
    constexpr Sample kTop = Limits::max();
    Sample low[kLanes];
    Sample high[kLanes];
    std::fill_n(low, kLanes, kTop);
    std::fill_n(high, kLanes, Limits::lowest());
    std::size_t finite = 0;
    const auto take = [&](std::size_t lane, Sample sample) {
        if constexpr (std::is_floating_point_v<Sample>) {
            const bool usable = std::abs(sample) <= kTop;
            low[lane] = usable && sample < low[lane] ? sample : low[lane];
            high[lane] = usable && sample > high[lane] ? sample : high[lane];
            finite += usable ? 1 : 0;
        } else {
            low[lane] = sample < low[lane] ? sample : low[lane];
            high[lane] = sample > high[lane] ? sample : high[lane];
        }
    };
    std::size_t i = 0;
    for (; i + kLanes <= count; i += kLanes) {
        for (std::size_t lane = 0; lane < kLanes; ++lane) take(lane, samples[i + lane]);
    }
    for (; i < count; ++i) take(0, samples[i]);
    if (!std::is_floating_point_v<Sample>) finite = count;
    if (finite == 0) return {1.0, 0.0, count};
    return {static_cast<double>(*std::min_element(low, low + kLanes)),
            static_cast<double>(*std::max_element(high, high + kLanes)), count - finite};
}

// The same for the samples from low to high; the comparison keeps NaN out.
template <class Sample>
Within within_of_chunk(const Sample* samples, std::size_t count, double low, double high) {
    Within found{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(), 0};
    double lowest[kLanes], highest[kLanes];
    std::fill_n(lowest, kLanes, found.minimum);
    std::fill_n(highest, kLanes, found.maximum);
    const auto take = [&](std::size_t lane, double sample) {
        const bool usable = sample >= low && sample <= high;
        lowest[lane] = usable && sample < lowest[lane] ? sample : lowest[lane];
        highest[lane] = usable && sample > highest[lane] ? sample : highest[lane];
        found.count += usable ? 1 : 0;
    };
    std::size_t i = 0;
    for (; i + kLanes <= count; i += kLanes) {
        for (std::size_t lane = 0; lane < kLanes; ++lane) take(lane, static_cast<double>(samples[i + lane]));
    }
    for (; i < count; ++i) take(0, static_cast<double>(samples[i]));
    found.minimum = *std::min_element(lowest, lowest + kLanes);
    found.maximum = *std::max_element(highest, highest + kLanes);
    return found;
}

// Four tables in turn: with one, a run of equal samples would load the same counter again right after it was stored,
// and wait for the store each time.
template <class Sample>
void count_exact(const Sample* samples, std::size_t count, std::int64_t low, std::size_t bins, std::uint64_t* out) {
    constexpr std::size_t kTables = 4;
    std::vector<std::uint32_t> tables(kTables * bins);
    const auto add = [&](std::size_t table, Sample sample) {
        const std::size_t bin = static_cast<std::size_t>(static_cast<std::int64_t>(sample) - low);
        if (bin < bins) ++tables[table * bins + bin];
    };
    // A 32-bit count cannot overflow within so many samples.
    constexpr std::size_t kRound = std::size_t{1} << 31;
    for (std::size_t first = 0; first < count; first += kRound) {
        const std::size_t last = std::min(count, first + kRound);
        std::size_t i = first;
        for (; i + kTables <= last; i += kTables) {
            for (std::size_t table = 0; table < kTables; ++table) add(table, samples[i + table]);
        }
        for (; i < last; ++i) add(0, samples[i]);
        for (std::size_t slot = 0; slot < kTables * bins; ++slot) out[slot % bins] += tables[slot];
        std::fill(tables.begin(), tables.end(), 0U);
    }
}

// kScaled: samples are multiplied by `unit` first. A range beyond the largest double, or so small that its inverse is,
// is reckoned in another unit, a power of two.
template <bool kScaled, class Sample>
void count_binned(const Sample* samples, std::size_t count, double low, double high, double unit, std::size_t bins,
                  std::uint64_t* out) {
    const double first = kScaled ? low * unit : low, range = kScaled ? high * unit - first : high - first;
    const double scale = high > low ? static_cast<double>(bins) / range : 0.0;
    for (std::size_t i = 0; i < count; ++i) {
        const double sample = static_cast<double>(samples[i]);
        if (!(sample >= low && sample <= high)) continue;
        const std::size_t bin = static_cast<std::size_t>(((kScaled ? sample * unit : sample) - first) * scale);
        ++out[std::min(bin, bins - 1)];
    }
}

double unit_for(double low, double high) {
    if (!std::isfinite(high - low)) return 0.5;
    return high > low && high - low < 0x1p-960 ? 0x1p100 : 1.0;
}

template <class Sample>
bool is_exact(double low, double high, std::size_t bins) {
    return std::is_integral_v<Sample> && bins <= 65536 && low == std::floor(low) &&
           high - low + 1.0 == static_cast<double>(bins);
}

}  // namespace

template <class Sample>
Extent extent(const Sample* samples, std::size_t count, int threads) {
    const std::size_t chunks = chunk_count(count, threads);
    std::vector<Extent> parts(chunks);
    over_chunks(count, chunks, threads, [&](std::size_t chunk, std::size_t first, std::size_t last) {
        parts[chunk] = extent_of_chunk(samples + first, last - first);
    });
    Extent whole{1.0, 0.0, 0};
    for (const Extent& part : parts) {
        whole.nonfinite += part.nonfinite;
        if (part.minimum > part.maximum) continue;
        const bool first = whole.minimum > whole.maximum;
        whole.minimum = first ? part.minimum : std::min(whole.minimum, part.minimum);
        whole.maximum = first ? part.maximum : std::max(whole.maximum, part.maximum);
    }
    return whole;
}

template <class Sample>
Within extent_between(const Sample* samples, std::size_t count, double low, double high, int threads) {
    const std::size_t chunks = chunk_count(count, threads);
    std::vector<Within> parts(chunks);
    over_chunks(count, chunks, threads, [&](std::size_t chunk, std::size_t first, std::size_t last) {
        parts[chunk] = within_of_chunk(samples + first, last - first, low, high);
    });
    Within whole = parts[0];
    for (std::size_t chunk = 1; chunk < chunks; ++chunk) {
        whole.minimum = std::min(whole.minimum, parts[chunk].minimum);
        whole.maximum = std::max(whole.maximum, parts[chunk].maximum);
        whole.count += parts[chunk].count;
    }
    return whole;
}

template <class Sample>
Array<std::uint64_t> histogram(const Sample* samples, std::size_t count, double low, double high, std::size_t bins,
                               int threads) {
    if (!(low <= high) || bins == 0) throw std::invalid_argument("a histogram needs low <= high and one bin or more");
    const std::size_t chunks = chunk_count(count, threads);
    std::vector<std::vector<std::uint64_t>> parts(chunks);
    over_chunks(count, chunks, threads, [&](std::size_t chunk, std::size_t first, std::size_t last) {
        parts[chunk].assign(bins, 0);
        if constexpr (std::is_integral_v<Sample>) {
            if (is_exact<Sample>(low, high, bins)) {
                return count_exact(samples + first, last - first, static_cast<std::int64_t>(low), bins,
                                   parts[chunk].data());
            }
        }
        const double unit = unit_for(low, high);
        const auto count_all = unit == 1.0 ? count_binned<false, Sample> : count_binned<true, Sample>;
        count_all(samples + first, last - first, low, high, unit, bins, parts[chunk].data());
    });
    Array<std::uint64_t> counts(bins);
    std::fill(counts.begin(), counts.end(), 0U);
    for (const auto& part : parts) {
        for (std::size_t bin = 0; bin < bins; ++bin) counts[bin] += part[bin];
    }
    return counts;
}

#define ISOCORE_STATISTICS(Sample)                                                   \
    template Extent extent(const Sample*, std::size_t, int);                         \
    template Within extent_between(const Sample*, std::size_t, double, double, int); \
    template Array<std::uint64_t> histogram(const Sample*, std::size_t, double, double, std::size_t, int);
ISOCORE_FOR_EACH_SAMPLE_TYPE(ISOCORE_STATISTICS)
#undef ISOCORE_STATISTICS

}  // namespace isocore
