// ring.hpp - The quick look at a link: is it the plain ring that nearly every vertex has?
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "surface/corners.hpp"

#if defined(__AVX2__)
#include <immintrin.h>
#elif defined(__SSE2__) || defined(_M_X64)
#include <emmintrin.h>
#endif

namespace isocore {

// Bit i says whether edge i starts at `place`; slots that are not in use get a bit as well.
template <class Offset>
std::uint32_t starting_at(const Slots<Offset>& link, Offset place) {
    std::uint32_t bits = 0;
    for (std::size_t i = 0; i < kSlots; ++i) bits |= static_cast<std::uint32_t>(link.edges[i].from == place) << i;
    return bits;
}

// Bit i says whether edge i leads to an earlier vertex, and bit kSlots + i whether it starts at one.
template <class Offset>
std::uint32_t earlier_ends(const Slots<Offset>& link) {
    std::uint32_t bits = 0;
    for (std::size_t i = 0; i < kSlots; ++i) {
        bits |= static_cast<std::uint32_t>(link.edges[i].to < 0) << i;
        bits |= static_cast<std::uint32_t>(link.edges[i].from < 0) << (i + kSlots);
    }
    return bits;
}

#if defined(__SSE2__) || defined(_M_X64)
// A link of 16-bit offsets: the eight edges' starts in one register, their ends in another.
struct LinkRegisters {
    __m128i from;
    __m128i to;

    explicit LinkRegisters(const Slots<std::int16_t>& link) {
        const auto* pairs = reinterpret_cast<const __m128i*>(link.edges.data());
        const __m128i low = _mm_load_si128(pairs), high = _mm_load_si128(pairs + 1);
        from =
            _mm_packs_epi32(_mm_srai_epi32(_mm_slli_epi32(low, 16), 16), _mm_srai_epi32(_mm_slli_epi32(high, 16), 16));
        to = _mm_packs_epi32(_mm_srai_epi32(low, 16), _mm_srai_epi32(high, 16));
    }
};

inline std::uint32_t starting_at(const Slots<std::int16_t>& link, std::int16_t place) {
    const __m128i found = _mm_cmpeq_epi16(LinkRegisters(link).from, _mm_set1_epi16(place));
    return static_cast<std::uint32_t>(_mm_movemask_epi8(_mm_packs_epi16(found, _mm_setzero_si128())));
}

inline std::uint32_t starting_at(const Slots<std::int32_t>& link, std::int32_t place) {
    const auto* pairs = reinterpret_cast<const __m128*>(link.edges.data());
    const __m128i wanted = _mm_set1_epi32(place);
    const auto four = [&](std::size_t i) {
        const __m128 from = _mm_shuffle_ps(pairs[i], pairs[i + 1], _MM_SHUFFLE(2, 0, 2, 0));
        return _mm_cmpeq_epi32(_mm_castps_si128(from), wanted);
    };
    const __m128i found = _mm_packs_epi32(four(0), four(2));
    return static_cast<std::uint32_t>(_mm_movemask_epi8(_mm_packs_epi16(found, _mm_setzero_si128())));
}

inline std::uint32_t earlier_ends(const Slots<std::int16_t>& link) {
    const LinkRegisters edges(link);
    return static_cast<std::uint32_t>(_mm_movemask_epi8(_mm_packs_epi16(edges.to, edges.from)));
}
#endif

// True if the link is one ring that all triangles run along in one direction: then every edge at the vertex has
// exactly two triangles, in opposite directions. False also for links that the slots cannot hold.
//
// The link is followed by table look-up in one word (SWAR): six bits for every edge hold six times the number of the
// next edge, which is the shift that reaches its own entry, or that of a ninth edge for "none", which leads to itself.
// Eight steps from the first edge then pass all `count` edges, and nothing else, only if the way is a ring: from an
// edge that starts where an earlier one starts nothing comes back, because only the earlier one is ever next. The loops
// run over all slots, used or not, because that costs less than a branch misprediction.
template <class Offset>
bool is_plain_ring(const Slots<Offset>& link, std::size_t count) {
    if (count < 2 || count > kSlots) return false;
    const std::uint32_t used = (1U << count) - 1;
    constexpr std::uint32_t kBits = 6;
    constexpr std::uint32_t kNone = 1U << kSlots;
    std::uint64_t after = std::uint64_t{kBits * kSlots} << (kBits * kSlots);
    for (std::size_t i = 0; i < kSlots; ++i) {
        const std::uint32_t next = (starting_at(link, link.edges[i].to) & used) | kNone;
        after |= static_cast<std::uint64_t>(kBits * static_cast<std::uint32_t>(std::countr_zero(next))) << (kBits * i);
    }
    std::uint64_t at = 0;
    std::uint64_t passed = 0;
    for (std::size_t step = 0; step < kSlots; ++step) {
        at = after >> at & 63;
        passed |= std::uint64_t{1} << at;
    }
    constexpr std::uint64_t kEverySlot = 0x0410'4104'1041;  // one bit in six, eight times
    return passed == (kEverySlot & ((std::uint64_t{1} << (kBits * count)) - 1));
}

// Link edges of a plain ring that lead from a later vertex to an earlier one, one bit each: where a run of earlier
// neighbours begins. 1 if all neighbours are earlier, 0 if none is.
template <class Offset>
std::uint32_t starts_of_earlier_runs(const Slots<Offset>& ring, std::size_t count) {
    const std::uint32_t used = (1U << count) - 1;
    const std::uint32_t earlier = earlier_ends(ring);
    const std::uint32_t to_earlier = earlier & used;
    return to_earlier == used ? 1 : to_earlier & ~(earlier >> kSlots);
}

#if defined(__AVX2__)
// For the slot in every lane (0..7, then 4..7, 0..3), the two bytes by which a shuffle picks the slot `step` further
// on.
template <int step>
__m256i numbers_after() {
    static constexpr auto bytes = [] {
        std::array<std::uint8_t, 32> pairs{};
        for (std::size_t lane = 0; lane < 16; ++lane) {
            const std::size_t slot = (lane + step + (lane < 8 ? 0 : 4)) % kSlots;
            pairs[2 * lane] = static_cast<std::uint8_t>(2 * slot);
            pairs[2 * lane + 1] = static_cast<std::uint8_t>(2 * slot + 1);
        }
        return pairs;
    }();
    return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(bytes.data()));
}

// The same ring for short offsets, all slots at once. `next` holds for every edge the number of the one after it, as a
// pair of bytes to shuffle by. The edges passed in one, two, four, eight steps then follow by shuffling what was
// passed so far: an edge without a next one gives none. Where several begin at one vertex, all that lead there find
// one and the same number, made of theirs: then there are fewer numbers than edges, and some edge is never passed.
inline bool is_plain_ring(const Slots<std::int16_t>& link, std::size_t count) {
    if (count < 2 || count > kSlots) return false;
    const LinkRegisters edges(link);
    const __m128i lanes = _mm_setr_epi16(0, 1, 2, 3, 4, 5, 6, 7);
    const __m128i used = _mm_cmpgt_epi16(_mm_set1_epi16(static_cast<std::int16_t>(count)), lanes);
    // Slots 0..7 and, above them, 4..7, 0..3: turned by none to three they pair every slot with every other.
    const __m256i from =
        _mm256_permute4x64_epi64(_mm256_castsi128_si256(_mm_and_si128(edges.from, used)), 0b00'01'01'00);
    const __m256i to = _mm256_broadcastsi128_si256(edges.to);
    const __m256i found0 = _mm256_cmpeq_epi16(to, from);
    const __m256i found1 = _mm256_cmpeq_epi16(to, _mm256_alignr_epi8(from, from, 2));
    const __m256i found2 = _mm256_cmpeq_epi16(to, _mm256_alignr_epi8(from, from, 4));
    const __m256i found3 = _mm256_cmpeq_epi16(to, _mm256_alignr_epi8(from, from, 6));
    const __m256i any = _mm256_or_si256(_mm256_or_si256(found0, found1), _mm256_or_si256(found2, found3));
    const __m256i numbers = _mm256_or_si256(
        _mm256_or_si256(_mm256_and_si256(found0, numbers_after<0>()), _mm256_and_si256(found1, numbers_after<1>())),
        _mm256_or_si256(_mm256_and_si256(found2, numbers_after<2>()), _mm256_and_si256(found3, numbers_after<3>())));
    const __m128i found = _mm_or_si128(_mm256_castsi256_si128(any), _mm256_extracti128_si256(any, 1));
    const __m128i none = _mm_andnot_si128(found, _mm_set1_epi8(-1));
    __m128i next = _mm_or_si128(_mm256_castsi256_si128(numbers), _mm256_extracti128_si256(numbers, 1));
    next = _mm_or_si128(next, none);
    __m128i passed = _mm_shuffle_epi8(_mm_setr_epi16(1, 2, 4, 8, 16, 32, 64, 128), next);
    for (int doubling = 0; doubling < 3; ++doubling) {
        passed = _mm_or_si128(passed, _mm_shuffle_epi8(passed, next));
        next = _mm_or_si128(_mm_shuffle_epi8(next, next), none);
    }
    return (_mm_cvtsi128_si32(passed) & 0xffff) == (1 << count) - 1;
}
#endif

}  // namespace isocore
