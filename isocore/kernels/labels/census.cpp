// census.cpp - Samples are counted by runs: a label map holds long ones, so that few samples are looked up at all.
#include "labels/census.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <type_traits>
#include <unordered_map>
#include <utility>

#include "samples/sample_types.hpp"

namespace isocore::labels {

template <class Sample>
Census take_census(const Sample* samples, std::size_t count, std::size_t most) {
    Census census;
    std::unordered_map<Sample, std::uint64_t> counted;
    for (std::size_t begin = 0; begin < count;) {
        const Sample value = samples[begin];
        if constexpr (std::is_floating_point_v<Sample>) {
            if (std::isnan(value)) {
                ++census.not_a_number;
                ++begin;
                continue;
            }
            if (!std::isfinite(value) || value != std::floor(value)) {
                census.not_whole = static_cast<double>(value);
                break;
            }
        }
        std::size_t end = begin + 1;
        constexpr std::size_t kAtOnce = 8;
        std::array<Sample, kAtOnce> same;
        same.fill(value);
        while (end + kAtOnce <= count && std::memcmp(samples + end, same.data(), sizeof same) == 0) end += kAtOnce;
        while (end < count && samples[end] == value) ++end;
        counted[static_cast<Sample>(value + Sample{0})] += end - begin;  // -0 is 0
        begin = end;
        if (counted.size() > most) {
            census.too_many = true;
            break;
        }
    }
    std::vector<std::pair<Sample, std::uint64_t>> sorted(counted.begin(), counted.end());
    std::sort(sorted.begin(), sorted.end());
    for (const auto& [value, number] : sorted) {
        census.values.push_back(static_cast<double>(value));
        census.counts.push_back(number);
    }
    return census;
}

#define ISOCORE_CENSUS(Sample) template Census take_census(const Sample*, std::size_t, std::size_t);
ISOCORE_FOR_EACH_SAMPLE_TYPE(ISOCORE_CENSUS)
#undef ISOCORE_CENSUS

}  // namespace isocore::labels
