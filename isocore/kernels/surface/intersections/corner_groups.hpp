// corner_groups.hpp - The corners of eight triangles at a time, to see at once which of them share one with another.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "surface/nearness/box_tree.hpp"

namespace isocore::intersections {

using nearness::kLanes;

// Which of eight triangles share a corner with another one, a bit each; settled: a corner whose fan is tidy.
struct Sharing {
    std::uint32_t any = 0, settled = 0;
};

struct alignas(32) CornerGroup {
    std::array<std::array<std::int32_t, kLanes>, 3> vertices;
    std::array<std::uint8_t, kLanes> tidy;  // a bit for each of the three corners

    Sharing with(const CornerGroup& other, std::size_t lane) const {
        Sharing sharing;
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const std::uint32_t equal = holding(other.vertices[corner][lane]);
            sharing.any |= equal;
            sharing.settled |= (other.tidy[lane] >> corner & 1) != 0 ? equal : 0;
        }
        return sharing;
    }

  private:
    std::uint32_t holding(std::int32_t vertex) const {
#if defined(__AVX2__)
        const __m256i wanted = _mm256_set1_epi32(vertex);
        __m256i equal = _mm256_setzero_si256();
        for (const auto& lanes : vertices) {
            const __m256i there = _mm256_load_si256(reinterpret_cast<const __m256i*>(lanes.data()));
            equal = _mm256_or_si256(equal, _mm256_cmpeq_epi32(there, wanted));
        }
        return static_cast<std::uint32_t>(_mm256_movemask_ps(_mm256_castsi256_ps(equal)));
#else
        std::uint32_t bits = 0;
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            const bool equal =
                (vertices[0][lane] == vertex) | (vertices[1][lane] == vertex) | (vertices[2][lane] == vertex);
            bits |= static_cast<std::uint32_t>(equal) << lane;
        }
        return bits;
#endif
    }
};

}  // namespace isocore::intersections
