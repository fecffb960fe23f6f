// corner_signs.hpp - Which corners of a mesh's cell lie inside, by the rule of crossing.hpp: four corners at once where
// the processor can compare four values.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "common/crossing.hpp"
#include "common/mesh_cells.hpp"

#if defined(__AVX2__)
#include <immintrin.h>
#endif

namespace isocore::mesh {

template <class Value>
class CornerSigns {
    static_assert(std::is_floating_point_v<Value>);

  public:
    explicit CornerSigns(double isovalue) {
        const Inside<Value> inside(isovalue, false);
        lowest_ = inside.nothing ? std::numeric_limits<Value>::infinity() : inside.lowest;
        highest_ = inside.highest;
    }

    // A bit for each of the cell's corners, the first one's is the lowest.
    template <class Cell>
    Mask of(const Value* values, const std::int32_t* corners) const {
        Mask signs = 0;
        for (std::size_t n = 0; n < Cell::kCorners; n += 4) signs |= of_four(values, corners + n) << n;
        return signs;
    }

  private:
#if defined(__AVX2__)
    Mask of_four(const Value* values, const std::int32_t* corners) const {
        if constexpr (std::is_same_v<Value, double>) {
            const __m256d four =
                _mm256_set_pd(values[corners[3]], values[corners[2]], values[corners[1]], values[corners[0]]);
            return static_cast<Mask>(
                _mm256_movemask_pd(_mm256_and_pd(_mm256_cmp_pd(four, _mm256_set1_pd(lowest_), _CMP_GE_OQ),
                                                 _mm256_cmp_pd(four, _mm256_set1_pd(highest_), _CMP_LE_OQ))));
        } else {
            const __m128 four =
                _mm_set_ps(values[corners[3]], values[corners[2]], values[corners[1]], values[corners[0]]);
            return static_cast<Mask>(_mm_movemask_ps(
                _mm_and_ps(_mm_cmpge_ps(four, _mm_set1_ps(lowest_)), _mm_cmple_ps(four, _mm_set1_ps(highest_)))));
        }
    }
#else
    Mask of_four(const Value* values, const std::int32_t* corners) const {
        Mask signs = 0;
        for (std::size_t n = 0; n < 4; ++n) {
            const Value value = values[corners[n]];
            signs |= static_cast<Mask>((value >= lowest_) & (value <= highest_)) << n;
        }
        return signs;
    }
#endif

    Value lowest_, highest_;
};

}  // namespace isocore::mesh
