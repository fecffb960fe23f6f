// dike.hpp - A dike is a dyadic segment of a lign, named by its label: 1 is the whole lign of N cells, and the halves
// of dike k are 2k and 2k + 1, as in a binary heap (section 3.1 of the paper). A word holds one bit for each dike of a
// lign. For N = 4:
//
//     sample      0     1     2     3     4
//                 |-----------1-----------|      label 1, length 4:          bit 2, its middle sample
//                 |-----2-----|-----3-----|      labels 2 and 3, length 2:   bits 1 and 3, their middle samples
//                 |--4--|--5--|--6--|--7--|      labels 4 to 7, unit dikes:  bits 4 to 7, their labels
//
//     bit         7   6   5   4   3   2   1   0
//     label       7   6   5   4   3   1   2   -  (bit 0 is no dike's)
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

    // The label's number of halvings from the whole lign; the dike's length, and its first and last sample.
    static constexpr int level(Label label) { return std::bit_width(label) - 1; }
    static constexpr int length(Label label) { return N >> level(label); }
    static constexpr int start(Label label) { return static_cast<int>(label << (kDepth - level(label))) - N; }
    static constexpr int end(Label label) { return start(label) + length(label); }
    static constexpr bool is_unit(Label label) { return label >= static_cast<Label>(N); }
};

// Answers for all dikes of a lign, one bit each: the bit of a unit dike is its label, that of any other dike is its
// middle sample. No two dikes share a bit, and going from all dikes of one length to all twice as long is one shift.
//
// What goes in are marks of the samples of a lign (bit s is sample s, N + 1 bits) or of its steps (bit s is the step
// from sample s to s + 1, N bits). The examples are for N = 4; sets are of bits, dikes are given by label.
template <int N>
struct DikeBits {
    using Word = std::conditional_t<(N <= 16), std::uint32_t, std::uint64_t>;
    static constexpr Word kSamples = static_cast<Word>((std::uint64_t{1} << (N + 1)) - 1);
    static constexpr Word kUnits = kSamples >> 1;  // all N steps of the lign

    // The bit of a dike.
    static constexpr int bit(Label label) { return kBits[label]; }

    // The dikes with a marked sample, their ends included. Sample {2}: dikes 5, 6, 2, 3, 1.
    ISOCORE_INLINED static Word over_samples(Word marked) { return over_steps(marked | marked >> 1); }
    // The dikes with a marked step. Step {1}: dikes 5, 2, 1.
    ISOCORE_INLINED static Word over_steps(Word marked) { return units(marked) | widened<1>(marked); }
    // The dikes that start at a marked sample. Sample {2}: dikes 6, 3.
    ISOCORE_INLINED static Word starting(Word marked) { return units(marked) | shifted<1, 0>(marked); }
    // The dikes that end at a marked sample. Sample {2}: dikes 5, 2.
    ISOCORE_INLINED static Word ending(Word marked) { return units(marked >> 1) | shifted<1, 1>(marked); }
    // Here `marked` has one bit for each dike itself. The dikes whose lower half is marked. Dikes 6, 2: dikes 3, 1.
    ISOCORE_INLINED static Word with_lower_half(Word marked) { return halves<2, 0>(marked); }
    // The dikes whose upper half is marked. Dikes 7, 3: dikes 3, 1.
    ISOCORE_INLINED static Word with_upper_half(Word marked) { return halves<2, 1>(marked); }
    // The dikes that are crossed more than once, by the signs of the lign's samples. Inside are {1, 2, 4}, so that
    // steps {0, 2, 3} are crossed: dikes 3, 1.
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

    // The following four go level by level, from dikes of length `half` to those of length 2 half. They are templates,
    // so that their levels are unrolled and loops that call them vectorise.

    // Prefix OR by doubling: on entry bit s says whether any of the `half` steps from s on is marked.
    // Steps {1}: {0, 1} says it of two steps from s on, of which 0 starts dike 2 (bit 1); then 0 starts dike 1 (bit 2).
    template <int half>
    ISOCORE_INLINED static Word widened(Word marked) {
        if constexpr (half < N) {
            marked |= marked >> half;
            return (marked & starts(2 * half)) << half | widened<2 * half>(marked);
        }
        return 0;
    }
    // Moves the mark of each dike's first sample, or of its last one, to its middle sample.
    // Sample {2}, at_end = 0: 2 starts dike 3, whose middle is bit 3. at_end = 1: 2 ends dike 2, whose middle is bit 1.
    template <int half, int at_end>
    ISOCORE_INLINED static Word shifted(Word marked) {
        if constexpr (half < N)
            return (marked >> 2 * half * at_end & starts(2 * half)) << half | shifted<2 * half, at_end>(marked);
        return 0;
    }
    // On entry bit s, a multiple of `half`, says whether the dike of length `half` from s on is crossed at all (any),
    // or more than once (several). A dike is crossed more than once if one of its halves is, or if both are crossed.
    // Any {0, 2, 3}: 2 and 3 are the halves of dike 3 (bit 3); then any {0, 2}, several {2}: dike 1 (bit 2).
    template <int half>
    ISOCORE_INLINED static Word doubled(Word any, Word several) {
        if constexpr (half < N) {
            const Word twice = (several | several >> half | (any & any >> half)) & starts(2 * half);
            return twice << half | doubled<2 * half>((any | any >> half) & starts(2 * half), twice);
        }
        return 0;
    }
    // Moves the bit of each dike's lower half, or of its upper one, to the dike's own bit: from a unit dike's label, or
    // from a middle sample, which is length / 4 away. Dikes 6, 2 (bits 6, 1), upper = 0: bits 3, 2 (dikes 3, 1).
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
    // Moves the marks of steps to the labels of their unit dikes. Steps {0, 3}: bits 4, 7.
    ISOCORE_INLINED static Word units(Word marked) { return static_cast<Word>((marked & kUnits) << (N - 1) << 1); }
    // The samples at which dikes of this length start. Length 2: {0, 2}.
    static constexpr Word starts(int length) {
        Word out = 0;
        for (int s = 0; s < N; s += length) out |= Word{1} << s;
        return out;
    }
};

}  // namespace isocore::climbing
