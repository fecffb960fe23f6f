// neighbours.hpp - The cells across the crossed faces of a cell.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "common/mesh_cells.hpp"

#if defined(__AVX2__)
#include <immintrin.h>
#endif

namespace isocore::thinning {

template <class Cell>
struct Neighbours {
    alignas(16) std::array<std::uint32_t, Cell::kFaces> cells;  // 0 where there is none
    mesh::Mask there;                                           // by face

    void find(const std::int32_t* twins, mesh::Mask crossed) {
#if defined(__AVX2__)
        if constexpr (Cell::kFaces == 4) {  // all at once
            const __m128i known = _mm_loadu_si128(reinterpret_cast<const __m128i*>(twins));
            there = crossed & ~static_cast<mesh::Mask>(_mm_movemask_ps(_mm_castsi128_ps(known)));
            _mm_store_si128(reinterpret_cast<__m128i*>(cells.data()),
                            _mm_srli_epi32(_mm_andnot_si128(_mm_srai_epi32(known, 31), known), 2));
            return;
        }
#endif
        there = 0;
        for (std::size_t face = 0; face < Cell::kFaces; ++face) {
            const auto twin = static_cast<std::uint32_t>(twins[face]), here = crossed >> face & ~(twin >> 31) & 1;
            there |= here << face;
            cells[face] = (twin & -here) / Cell::kFaces;
        }
    }

    std::uint64_t bit(std::size_t face) const { return there >> face & 1; }
};

}  // namespace isocore::thinning
