// bit_fields.hpp - Gathering chosen bits of a word and scattering them again: one instruction with BMI2 (pext, pdep),
// a loop elsewhere. And words of 64 bits read from and written to any byte.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

#if defined(__BMI2__) || (defined(_MSC_VER) && defined(__AVX2__))
#include <immintrin.h>
#define ISOCORE_HAS_BMI2
#endif

namespace isocore {

// The bits of `word` at the `places` that are set, moved together into the lowest bits of the result (pext).
inline std::uint64_t extract_bits(std::uint64_t word, std::uint64_t places) {
#if defined(ISOCORE_HAS_BMI2)
    return _pext_u64(word, places);
#else
    std::uint64_t out = 0;
    for (std::uint64_t bit = 1; places; places &= places - 1, bit <<= 1) out |= places & -places & word ? bit : 0;
    return out;
#endif
}

// The inverse (pdep): the lowest bits of `bits`, each moved to one of the set `places`, in order.
inline std::uint64_t deposit_bits(std::uint64_t bits, std::uint64_t places) {
#if defined(ISOCORE_HAS_BMI2)
    return _pdep_u64(bits, places);
#else
    std::uint64_t out = 0;
    for (; places; places &= places - 1, bits >>= 1) out |= places & -places & -(bits & 1);
    return out;
#endif
}

// Loads a word from eight bytes at any address, and stores the first `count` bytes of some words: the lowest bits come
// first, whatever the machine's byte order.
inline std::uint64_t load_bits(const std::uint8_t* bytes) {
    std::uint64_t word;
    if constexpr (std::endian::native == std::endian::little) {
        std::memcpy(&word, bytes, sizeof word);
    } else {
        word = 0;
        for (std::size_t n = 0; n < sizeof word; ++n) word |= std::uint64_t{bytes[n]} << 8 * n;
    }
    return word;
}
inline void store_bits(const std::uint64_t* words, std::uint8_t* bytes, std::size_t count) {
    if constexpr (std::endian::native == std::endian::little) {
        std::memcpy(bytes, words, count);
    } else {
        for (std::size_t n = 0; n < count; ++n) bytes[n] = static_cast<std::uint8_t>(words[n / 8] >> 8 * (n % 8));
    }
}

// The 64 bits that start at bit `first` of an array of words. Reads word first / 64 + 1 as well, so it must be there.
inline std::uint64_t bits_from(const std::uint64_t* words, std::size_t first) {
    return words[first / 64] >> first % 64 | words[first / 64 + 1] << 1 << (63 - first % 64);
}

// A word whose lowest `count` bits are set; count is at most 64.
inline std::uint64_t lowest_bits(std::size_t count) {
#if defined(ISOCORE_HAS_BMI2)
    return _bzhi_u64(~std::uint64_t{0}, static_cast<unsigned>(count));
#else
    return count == 0 ? 0 : ~std::uint64_t{0} >> (64 - count);
#endif
}

}  // namespace isocore
