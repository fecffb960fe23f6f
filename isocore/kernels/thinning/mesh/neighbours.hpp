// neighbours.hpp - The cells across the crossed faces of a cell.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "common/mesh_cells.hpp"

#if defined(__AVX2__)
#include <immintrin.h>
#endif

namespace isocore::thinning {

// Calls visit(number) for each, without a loop: the numbers stay in registers then.
template <std::size_t count, class Visit>
void for_each(const std::array<std::int32_t, count>& numbers, const Visit& visit) {
    [&]<std::size_t... n>(std::index_sequence<n...>) { (visit(numbers[n]), ...); }(std::make_index_sequence<count>());
}

// The cells across the crossed faces of a cell; instead of others, the cell itself.
template <class Cell>
std::array<std::int32_t, Cell::kFaces> neighbours(Cell, std::int32_t cell, const std::int32_t* twins,
                                                  mesh::Mask signs) {
    const mesh::Mask crossed = mesh::kCrossedFaces<Cell>[signs];
    std::array<std::int32_t, Cell::kFaces> across;
    for (std::size_t face = 0; face < Cell::kFaces; ++face) {
        const std::int32_t there = -static_cast<std::int32_t>(crossed >> face & 1) & ~(twins[face] >> 31);
        across[face] = (twins[face] / static_cast<std::int32_t>(Cell::kFaces) & there) | (cell & ~there);
    }
    return across;
}

#if defined(__AVX2__)
// For every pattern of a tetrahedron's corner signs: all bits of the faces that are crossed.
struct alignas(16) FaceBits {
    std::array<std::int32_t, 4> bits;
};
inline constexpr auto kTetFaceBits = [] {
    std::array<FaceBits, 16> masks{};
    for (std::size_t signs = 0; signs < masks.size(); ++signs) {
        for (std::size_t face = 0; face < 4; ++face)
            masks[signs].bits[face] = mesh::kCrossedFaces<mesh::Tet>[signs] >> face & 1 ? -1 : 0;
    }
    return masks;
}();

// The same for all faces of a tetrahedron at once.
inline std::array<std::int32_t, 4> neighbours(mesh::Tet, std::int32_t cell, const std::int32_t* twins,
                                              mesh::Mask signs) {
    const __m128i known = _mm_loadu_si128(reinterpret_cast<const __m128i*>(twins)),
                  crossed = _mm_load_si128(reinterpret_cast<const __m128i*>(kTetFaceBits[signs].bits.data())),
                  there = _mm_andnot_si128(_mm_srai_epi32(known, 31), crossed);
    std::array<std::int32_t, 4> across;
    _mm_storeu_si128(reinterpret_cast<__m128i*>(across.data()),
                     _mm_blendv_epi8(_mm_set1_epi32(cell), _mm_srli_epi32(known, 2), there));
    return across;
}
#endif

}  // namespace isocore::thinning
