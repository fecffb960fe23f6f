// The sample of a rank against sorting, for every sample type and over all magnitudes.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <type_traits>
#include <vector>

#include "check.hpp"
#include "samples/sample_types.hpp"
#include "statistics/selection.hpp"
#include "statistics/statistics.hpp"

namespace {

using namespace isocore;

template <class Sample>
std::vector<Sample> of_all_magnitudes() {
    using Limits = std::numeric_limits<Sample>;
    std::vector<Sample> samples{Limits::lowest(), Limits::max(), 0, 1, 1, 1, 7};
    if constexpr (std::is_floating_point_v<Sample>) {
        for (Sample size = Limits::denorm_min(); size < Limits::max() / 1000; size *= 777) {
            samples.insert(samples.end(), {size, -size});
        }
        samples.insert(samples.end(), {-Sample{0}, Limits::min(), -Limits::min()});
    } else {
        for (std::size_t i = 0; i < 100; ++i) samples.push_back(static_cast<Sample>(Limits::max() / (i + 1)));
    }
    return samples;
}

template <class Sample>
void every_rank_is_as_if_sorted() {
    using Limits = std::numeric_limits<Sample>;
    const std::vector<Sample> sorted = [] {
        std::vector<Sample> samples = of_all_magnitudes<Sample>();
        std::sort(samples.begin(), samples.end());
        return samples;
    }();
    std::vector<Sample> mixed = of_all_magnitudes<Sample>();
    if constexpr (std::is_floating_point_v<Sample>) {
        mixed.insert(mixed.begin() + 3, {Limits::quiet_NaN(), -Limits::quiet_NaN(), Limits::infinity()});
        mixed.push_back(-Limits::infinity());
    }
    for (const std::size_t skipped : {std::size_t{0}, std::size_t{9}}) {
        const auto first = std::lower_bound(sorted.begin(), sorted.end(), sorted[skipped]);
        const auto low = static_cast<double>(*first), high = static_cast<double>(sorted.back());
        const auto left = static_cast<std::size_t>(sorted.end() - first);
        for (std::size_t rank = 0; rank < left; ++rank) {
            const Sample wanted = first[static_cast<std::ptrdiff_t>(rank)];
            const Ranked found = sample_of_rank(mixed.data(), mixed.size(), low, high, rank, 2);
            CHECK(found.value == static_cast<double>(wanted));
            const auto [from, to] = std::equal_range(first, sorted.end(), wanted);
            CHECK(found.below == static_cast<std::uint64_t>(from - first));
            CHECK(found.equal == static_cast<std::uint64_t>(to - from));
        }
        const Within all = extent_between(mixed.data(), mixed.size(), low, high, 2);
        CHECK(all.minimum == low && all.maximum == high && all.count == left);
        bool refused = false;
        try {
            sample_of_rank(mixed.data(), mixed.size(), low, high, left, 1);
        } catch (const std::invalid_argument&) {
            refused = true;
        }
        CHECK(refused);
    }
}

// Ranges that no double holds, or whose inverse none holds, have bins like any other.
void ranges_of_any_size_have_bins() {
    for (const double size : {1.7e308, 1.0, 5e-324, 4e-310}) {
        const std::vector<double> samples{-size, -size, 0, size};
        const Array<std::uint64_t> counts = histogram(samples.data(), samples.size(), -size, size, 4, 1);
        CHECK(counts[0] == 2 && counts[1] == 0 && counts[2] == 1 && counts[3] == 1);
    }
}

}  // namespace

void test_selection() {
    for_each_sample_type([]<class Sample>() { every_rank_is_as_if_sorted<Sample>(); });
    ranges_of_any_size_have_bins();
}
