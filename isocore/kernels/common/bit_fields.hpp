// bit_fields.hpp - Some bits of a word, moved close together or back: one instruction where the processor has it.
#pragma once

#include <cstddef>
#include <cstdint>

#if defined(__BMI2__) || (defined(_MSC_VER) && defined(__AVX2__))
#include <immintrin.h>
#define ISOCORE_HAS_BMI2
#endif

namespace isocore {

// The bits of `word` that `places` names, as the lowest bits of the result.
inline std::uint64_t extract_bits(std::uint64_t word, std::uint64_t places) {
#if defined(ISOCORE_HAS_BMI2)
    return _pext_u64(word, places);
#else
    std::uint64_t out = 0;
    for (std::uint64_t bit = 1; places; places &= places - 1, bit <<= 1) out |= places & -places & word ? bit : 0;
    return out;
#endif
}

// The other way round: the lowest bits of `bits`, each at one of the `places`.
inline std::uint64_t deposit_bits(std::uint64_t bits, std::uint64_t places) {
#if defined(ISOCORE_HAS_BMI2)
    return _pdep_u64(bits, places);
#else
    std::uint64_t out = 0;
    for (; places; places &= places - 1, bits >>= 1) out |= places & -places & -(bits & 1);
    return out;
#endif
}

// A word of `count` ones, at most 64.
inline std::uint64_t lowest_bits(std::size_t count) {
#if defined(ISOCORE_HAS_BMI2)
    return _bzhi_u64(~std::uint64_t{0}, static_cast<unsigned>(count));
#else
    return count == 0 ? 0 : ~std::uint64_t{0} >> (64 - count);
#endif
}

}  // namespace isocore
