// box_tree.hpp - Boxes around triangles, and around eight such boxes, and so on up to a single one: to find the pairs
// of triangles that are near each other. Triangles are put in the order of their places (Morton's), so that eight in a
// row are neighbours.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/array.hpp"
#include "surface/mesh_view.hpp"

#if defined(__AVX__)
#include <immintrin.h>
#endif

namespace isocore::nearness {

constexpr std::size_t kLanes = 8;

// Doubles times a power of two, less a centre: about one, so that boxes of single precision are tight.
struct Frame {
    double scale;
    Vec3 centre;
};

// For coordinates within bounds (lowest, then highest x, y, z). Afterwards no product of three of them is out of range.
Frame frame_around(const std::array<double, 6>& bounds);

struct Box {
    std::array<float, 3> low, high;
};

// Eight boxes, coordinate by coordinate.
struct alignas(32) Boxes {
    std::array<std::array<float, kLanes>, 3> low, high;

    Box at(std::size_t lane) const {
        return {{low[0][lane], low[1][lane], low[2][lane]}, {high[0][lane], high[1][lane], high[2][lane]}};
    }
    // One bit for each of the eight that has a point in common with `box`.
    std::uint32_t touched_by(const Box& box) const {
#if defined(__AVX__)
        __m256 touched = _mm256_castsi256_ps(_mm256_set1_epi32(-1));
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const __m256 below = _mm256_set1_ps(box.high[axis]), above = _mm256_set1_ps(box.low[axis]);
            touched = _mm256_and_ps(touched, _mm256_cmp_ps(_mm256_load_ps(low[axis].data()), below, _CMP_LE_OQ));
            touched = _mm256_and_ps(touched, _mm256_cmp_ps(_mm256_load_ps(high[axis].data()), above, _CMP_GE_OQ));
        }
        return static_cast<std::uint32_t>(_mm256_movemask_ps(touched));
#else
        std::uint32_t bits = 0;
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            const bool touched = (low[0][lane] <= box.high[0]) & (high[0][lane] >= box.low[0]) &
                                 (low[1][lane] <= box.high[1]) & (high[1][lane] >= box.low[1]) &
                                 (low[2][lane] <= box.high[2]) & (high[2][lane] >= box.low[2]);
            bits |= static_cast<std::uint32_t>(touched) << lane;
        }
        return bits;
#endif
    }
};

class BoxTree {
  public:
    // Boxes hold their triangles whatever the rounding. Triangles with a corner that is not finite are left out.
    template <class Real>
    BoxTree(const MeshView<Real>& mesh, const Frame& frame, int threads);

    // The group at the top, and how far above the triangles it is.
    std::size_t height() const { return levels_.size() - 1; }
    // The boxes of a node's eight children; at level 0, of triangles.
    const Boxes& boxes(std::size_t level, std::size_t node) const { return levels_[level][node]; }

    // Triangles in the tree's order.
    const Array<std::uint32_t>& order() const { return order_; }
    // Groups of eight triangles in a row; the last may not be full, and the lanes beyond touch nothing.
    std::size_t groups() const { return levels_.front().size(); }
    const Boxes& boxes(std::size_t group) const { return levels_.front()[group]; }
    Box box_of(std::size_t group) const { return levels_[1][group / kLanes].at(group % kLanes); }

    // Calls visit(other) for every group from `group` on whose box has a point in common with that of `group`.
    template <class Visit>
    void for_each_near(std::size_t group, const Visit& visit) const {
        descend(box_of(group), group, levels_.size() - 1, 0, visit);
    }

  private:
    template <class Visit>
    void descend(const Box& box, std::size_t from, std::size_t level, std::size_t node, const Visit& visit) const {
        if (level == 0) return visit(node);
        std::uint32_t touched = levels_[level][node].touched_by(box);
        // How many groups one child stands for: those before `from` are skipped.
        const std::size_t shift = 3 * (level - 1);
        for (; touched != 0; touched &= touched - 1) {
            const std::size_t child = kLanes * node + static_cast<std::size_t>(std::countr_zero(touched));
            if (child < from >> shift) continue;
            descend(box, from, level - 1, child, visit);
        }
    }

    Array<std::uint32_t> order_;
    std::vector<std::vector<Boxes>>
        levels_;  // first the boxes of triangles, then those of their groups; last a single group
};

}  // namespace isocore::nearness
