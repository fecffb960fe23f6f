// dike.hpp - A dike is a dyadic segment of a lign, named by its label: 1 is the whole lign of N cells, and the halves
// of dike k are 2k and 2k + 1 (section 3 of the paper). A word holds one answer for each dike of a lign.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <type_traits>

#include "common/inlined.hpp"

namespace isocore::climbing {

using Label = unsigned;

template <int N>
struct Dike {
    static_assert(std::has_single_bit(static_cast<unsigned>(N)) && N <= 32);
    static constexpr int kDepth = std::countr_zero(static_cast<unsigned>(N));

    static constexpr int level(Label label) { return std::bit_width(label) - 1; }
    static constexpr int length(Label label) { return N >> level(label); }
    static constexpr int start(Label label) { return static_cast<int>(label << (kDepth - level(label))) - N; }
    static constexpr int end(Label label) { return start(label) + length(label); }
    static constexpr bool is_unit(Label label) { return label >= static_cast<Label>(N); }
};

// A bit per dike: a unit dike's is its label, any other's is its middle sample, so that no two share one.
template <int N>
struct DikeBits {
    using Word = std::conditional_t<(N <= 16), std::uint32_t, std::uint64_t>;
    static constexpr Word kSamples = static_cast<Word>((std::uint64_t{1} << (N + 1)) - 1);
    static constexpr Word kUnits = kSamples >> 1;  // before they are shifted to their labels

    static constexpr int bit(Label label) { return kBits[label]; }

    // The dikes with a marked sample, their ends included.
    ISOCORE_INLINED static Word over_samples(Word marked) { return over_steps(marked | marked >> 1); }
    // The dikes with a marked step from one sample to the next.
    ISOCORE_INLINED static Word over_steps(Word marked) { return units(marked) | widened<1>(marked); }
    // The dikes that start, or end, at a marked sample.
    ISOCORE_INLINED static Word starting(Word marked) { return units(marked) | shifted<1, 0>(marked); }
    ISOCORE_INLINED static Word ending(Word marked) { return units(marked >> 1) | shifted<1, 1>(marked); }
    // The dikes whose lower, or upper, halves are marked.
    ISOCORE_INLINED static Word with_lower_half(Word marked) { return halves<2, 0>(marked); }
    ISOCORE_INLINED static Word with_upper_half(Word marked) { return halves<2, 1>(marked); }
    // The dikes that are crossed several times, by the samples of their lign.
    ISOCORE_INLINED static Word crossed_again(Word lign) { return doubled<1>((lign ^ lign >> 1) & kUnits, 0); }

  private:
    static constexpr std::array<std::uint8_t, 2 * N> kBits = [] {
        std::array<std::uint8_t, 2 * N> bits{};
        for (Label label = 1; label < 2 * N; ++label) {
            bits[label] = static_cast<std::uint8_t>(
                Dike<N>::is_unit(label) ? static_cast<int>(label) : Dike<N>::start(label) + Dike<N>::length(label) / 2);
        }
        return bits;
    }();

    // Level by level, from dikes of length `half` to those twice as long; templates, so that loops over them vectorise.
    template <int half>
    ISOCORE_INLINED static Word widened(Word marked) {
        if constexpr (half < N) {
            marked |= marked >> half;
            return (marked & starts(2 * half)) << half | widened<2 * half>(marked);
        }
        return 0;
    }
    template <int half, int at_end>
    ISOCORE_INLINED static Word shifted(Word marked) {
        if constexpr (half < N)
            return (marked >> 2 * half * at_end & starts(2 * half)) << half | shifted<2 * half, at_end>(marked);
        return 0;
    }
    template <int half>
    ISOCORE_INLINED static Word doubled(Word any, Word several) {
        if constexpr (half < N) {
            const Word twice = (several | several >> half | (any & any >> half)) & starts(2 * half);
            return twice << half | doubled<2 * half>((any | any >> half) & starts(2 * half), twice);
        }
        return 0;
    }
    template <int length, int upper>
    ISOCORE_INLINED static Word halves(Word marked) {
        if constexpr (length > N)
            return 0;
        else if constexpr (length == 2)
            return (marked >> (N - 1) >> upper & starts(2) << 1) | halves<4, upper>(marked);
        else
            return ((upper ? marked >> length / 4 : marked << length / 4) & starts(length) << length / 2) |
                   halves<2 * length, upper>(marked);
    }
    ISOCORE_INLINED static Word units(Word marked) { return static_cast<Word>((marked & kUnits) << (N - 1) << 1); }
    // Samples at which dikes of a length start.
    static constexpr Word starts(int length) {
        Word out = 0;
        for (int s = 0; s < N; s += length) out |= Word{1} << s;
        return out;
    }
};

}  // namespace isocore::climbing
