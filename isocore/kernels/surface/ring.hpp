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

// One bit per slot: whether it equals `value`, or is smaller.
#if defined(__AVX2__)
inline std::uint32_t bits_of(__m256i slots) {
    return static_cast<std::uint32_t>(_mm256_movemask_ps(_mm256_castsi256_ps(slots)));
}
inline std::uint32_t equal(const std::int32_t* slots, std::int32_t value) {
    return bits_of(_mm256_cmpeq_epi32(_mm256_load_si256(reinterpret_cast<const __m256i*>(slots)), _mm256_set1_epi32(value)));
}
inline std::uint32_t smaller(const std::int32_t* slots, std::int32_t value) {
    return bits_of(_mm256_cmpgt_epi32(_mm256_set1_epi32(value), _mm256_load_si256(reinterpret_cast<const __m256i*>(slots))));
}
#elif defined(__SSE2__) || defined(_M_X64)
inline std::uint32_t bits_of(__m128i low, __m128i high) {
    const __m128i all = _mm_packs_epi16(_mm_packs_epi32(low, high), _mm_setzero_si128());
    return static_cast<std::uint32_t>(_mm_movemask_epi8(all));
}
inline __m128i four(const std::int32_t* slots) { return _mm_load_si128(reinterpret_cast<const __m128i*>(slots)); }
inline std::uint32_t equal(const std::int32_t* slots, std::int32_t value) {
    const __m128i wanted = _mm_set1_epi32(value);
    return bits_of(_mm_cmpeq_epi32(four(slots), wanted), _mm_cmpeq_epi32(four(slots + 4), wanted));
}
inline std::uint32_t smaller(const std::int32_t* slots, std::int32_t value) {
    const __m128i limit = _mm_set1_epi32(value);
    return bits_of(_mm_cmplt_epi32(four(slots), limit), _mm_cmplt_epi32(four(slots + 4), limit));
}
#else
inline std::uint32_t equal(const std::int32_t* slots, std::int32_t value) {
    std::uint32_t bits = 0;
    for (std::size_t i = 0; i < kSlots; ++i) bits |= static_cast<std::uint32_t>(slots[i] == value) << i;
    return bits;
}
inline std::uint32_t smaller(const std::int32_t* slots, std::int32_t value) {
    std::uint32_t bits = 0;
    for (std::size_t i = 0; i < kSlots; ++i) bits |= static_cast<std::uint32_t>(slots[i] < value) << i;
    return bits;
}
#endif

// True if the link is one ring that all triangles run along in one direction: then every edge at the vertex has
// exactly two triangles, in opposite directions. False also for links that the slots cannot hold.
//
// Which link edge comes after which is kept in one word, six bits each: six times the number of the next edge, or
// of a ninth one for "none", which stays where it is. Eight steps from the first edge then pass all `count` edges,
// and nothing else, only if the way is a ring: from an edge that starts where an earlier one starts nothing comes
// back, because only the earlier one is ever next. The loops run over all slots, used or not, because that costs
// less than a branch predicted wrongly.
inline bool is_plain_ring(const Slots& link, std::size_t count) {
    if (count < 2 || count > kSlots) return false;
    const std::uint32_t used = (1U << count) - 1;
    constexpr std::uint32_t kBits = 6;
    constexpr std::uint32_t kNone = 1U << kSlots;
    std::uint64_t after = std::uint64_t{kBits * kSlots} << (kBits * kSlots);
    for (std::size_t i = 0; i < kSlots; ++i) {
        const std::uint32_t next = (equal(link.from.data(), link.to[i]) & used) | kNone;
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

// Link edges of a plain ring that lead from a vertex after `middle` to one before it, one bit each: where a run of
// earlier neighbours begins. 1 if all neighbours are earlier, 0 if none is.
inline std::uint32_t starts_of_earlier_runs(const Slots& ring, std::size_t count, std::int32_t middle) {
    const std::uint32_t used = (1U << count) - 1;
    const std::uint32_t to_earlier = smaller(ring.to.data(), middle) & used;
    return to_earlier == used ? 1 : to_earlier & ~smaller(ring.from.data(), middle);
}

}  // namespace isocore
