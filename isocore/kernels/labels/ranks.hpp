// ranks.hpp - A rank for every value of a label map: 0 for background, then by number.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <type_traits>
#include <vector>

namespace isocore::labels {

// Values are looked up in a table of all that a sample of 16 bits can be, or else by hashing. What is not in the table,
// NaN for one, is background.
class RankTable {
  public:
    // `values` (each once, any order) have the ranks of the same place.
    RankTable(std::span<const double> values, std::span<const std::uint32_t> ranks)
        : slots_(std::bit_ceil(2 * values.size() + 2)), direct_(std::size_t{1} << 16, 0) {
        for (const std::uint32_t rank : ranks) highest_ = std::max(highest_, rank);
        for (std::size_t n = 0; n < values.size(); ++n) {
            std::size_t slot = first_slot(values[n]);
            while (slots_[slot].used) slot = (slot + 1) & (slots_.size() - 1);
            slots_[slot] = {values[n], ranks[n], true};
            if (values[n] >= -32768 && values[n] <= 65535) {
                direct_[static_cast<std::uint16_t>(static_cast<std::int32_t>(values[n]))] = ranks[n];
            }
        }
    }

    std::uint32_t highest() const { return highest_; }

    // The ranks of `count` samples. Rank holds the highest.
    template <class Sample, class Rank>
    void look_up(const Sample* samples, std::size_t count, Rank* out) const {
        if constexpr (sizeof(Sample) <= 2) {
            // Values of one type of at most 16 bits never share a place of the table. Mostly a word's are all the same:
            // then the word is what it is turned by one of them.
            const auto rank = [&](std::size_t n) {
                return static_cast<Rank>(direct_[static_cast<std::uint16_t>(samples[n])]);
            };
            constexpr std::size_t kWord = sizeof(std::uint64_t) / sizeof(Sample);
            std::size_t n = 0;
            for (; n + kWord <= count; n += kWord) {
                std::uint64_t word;
                std::memcpy(&word, samples + n, sizeof word);
                if (word == std::rotl(word, 8 * sizeof(Sample))) {
                    std::fill_n(out + n, kWord, rank(n));
                } else {
                    for (std::size_t m = n; m < n + kWord; ++m) out[m] = rank(m);
                }
            }
            for (; n < count; ++n) out[n] = rank(n);
        } else {
            Sample last{};
            auto rank = static_cast<Rank>(rank_of(0));
            for (std::size_t n = 0; n < count; ++n) {
                if (samples[n] != last) {
                    last = samples[n];
                    rank = static_cast<Rank>(rank_of(static_cast<double>(last)));
                }
                out[n] = rank;
            }
        }
    }

  private:
    struct Slot {
        double value = 0;
        std::uint32_t rank = 0;
        bool used = false;
    };

    std::size_t first_slot(double value) const {
        const auto bits = std::bit_cast<std::uint64_t>(value + 0.0);  // -0 is 0
        return (bits * 0x9E3779B97F4A7C15u >> 20) & (slots_.size() - 1);
    }

    std::uint32_t rank_of(double value) const {
        for (std::size_t slot = first_slot(value); slots_[slot].used; slot = (slot + 1) & (slots_.size() - 1)) {
            if (slots_[slot].value == value) return slots_[slot].rank;
        }
        return 0;
    }

    std::vector<Slot> slots_;
    std::vector<std::uint32_t> direct_;
    std::uint32_t highest_ = 0;
};

}  // namespace isocore::labels
