// fours.hpp - Four 32-bit numbers picked from four, as the tables of tetrahedra say: one instruction where the
// processor has it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "thinning/mesh/edge_table.hpp"

#if defined(__AVX2__)
#include <immintrin.h>
#endif

namespace isocore::thinning {

// Which four of four: the bytes of each, as the processor wants to be told.
class Pick {
  public:
    constexpr Pick() = default;
    constexpr explicit Pick(const std::array<std::uint8_t, 4>& which) {
        for (std::size_t n = 0; n < bytes_.size(); ++n) bytes_[n] = static_cast<std::uint8_t>(4 * which[n / 4] + n % 4);
    }

#if defined(__AVX2__)
    __m128i of(const void* four) const {
        return _mm_shuffle_epi8(_mm_loadu_si128(static_cast<const __m128i*>(four)),
                                _mm_load_si128(reinterpret_cast<const __m128i*>(bytes_.data())));
    }
#else
    template <class Number>
    std::array<Number, 4> of(const Number* four) const {
        return {four[bytes_[0] / 4], four[bytes_[4] / 4], four[bytes_[8] / 4], four[bytes_[12] / 4]};
    }
#endif

  private:
    alignas(16) std::array<std::uint8_t, 16> bytes_{};
};

// Writes the edges between the four points that `a` picks and the four that `b` picks.
inline void write_edges(const std::int32_t* points, const Pick& a, const Pick& b, EdgeKey* out) {
#if defined(__AVX2__)
    const __m128i from = a.of(points), to = b.of(points), low = _mm_min_epi32(from, to), high = _mm_max_epi32(from, to);
    _mm_storeu_si128(reinterpret_cast<__m128i*>(out), _mm_unpacklo_epi32(high, low));
    _mm_storeu_si128(reinterpret_cast<__m128i*>(out + 2), _mm_unpackhi_epi32(high, low));
#else
    const auto from = a.of(points), to = b.of(points);
    for (std::size_t n = 0; n < 4; ++n) out[n] = edge_key(from[n], to[n]);
#endif
}

// Writes the four numbers that `pick` picks.
inline void write_four(const std::uint32_t* numbers, const Pick& pick, std::uint32_t* out) {
#if defined(__AVX2__)
    _mm_storeu_si128(reinterpret_cast<__m128i*>(out), pick.of(numbers));
#else
    const auto four = pick.of(numbers);
    for (std::size_t n = 0; n < 4; ++n) out[n] = four[n];
#endif
}

}  // namespace isocore::thinning
