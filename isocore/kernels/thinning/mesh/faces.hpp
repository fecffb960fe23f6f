// faces.hpp - Faces of cells by their points, and which of those at one point are the same.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "common/array.hpp"
#include "common/mesh_cells.hpp"

namespace isocore::thinning {

template <class Cell>
bool is_collapsed(const std::int32_t* ids) {
    bool equal = false;
    for (std::size_t a = 0; a < Cell::kCorners; ++a) {
        for (std::size_t b = a + 1; b < Cell::kCorners; ++b) equal |= ids[a] == ids[b];
    }
    return equal;
}

inline void order(std::int32_t& a, std::int32_t& b) {
    const std::int32_t low = std::min(a, b);
    b = std::max(a, b);
    a = low;
}

// A face by its points: the lowest, then for a triangle the others ascending, for a quadrilateral the opposite one and
// its two neighbours ascending.
inline std::array<std::int32_t, 4> named_points(mesh::Tet, const std::int32_t* ids, std::size_t face) {
    std::array<std::int32_t, 4> points{ids[face == 0], ids[1 + (face <= 1)], ids[2 + (face <= 2)], 0};
    order(points[0], points[1]);
    order(points[1], points[2]);
    order(points[0], points[1]);
    return points;
}

inline std::array<std::int32_t, 4> named_points(mesh::Hex, const std::int32_t* ids, std::size_t face) {
    const auto ring = cube::face_ring(static_cast<int>(face));
    const auto point = [&](std::size_t n) { return ids[ring[n & 3]]; };
    std::size_t low = 0;
    for (std::size_t n = 1; n < 4; ++n) low = point(n) < point(low) ? n : low;
    std::array<std::int32_t, 4> points{point(low), point(low + 2), point(low + 1), point(low + 3)};
    order(points[2], points[3]);
    return points;
}

// The face of a tetrahedron opposite to a corner has the corner's number; of a hexahedron, three faces are opposite.
template <class Cell>
inline constexpr std::array<mesh::Mask, Cell::kCorners> kOpposite = [] {
    std::array<mesh::Mask, Cell::kCorners> opposite{};
    for (std::size_t corner = 0; corner < Cell::kCorners; ++corner) {
        for (std::size_t face = 0; face < Cell::kFaces; ++face) {
            if (!(Cell::kShape.face_corners[face] >> corner & 1)) opposite[corner] |= mesh::Mask{1} << face;
        }
    }
    return opposite;
}();

template <class Cell>
std::size_t lowest_corner(const std::int32_t* ids) {
    std::size_t low = 0;
    for (std::size_t n = 1; n < Cell::kCorners; ++n) low = ids[n] < ids[low] ? n : low;
    return low;
}

// The faces seen at one point, in a hash table with room for twice as many.
class Matcher {
  public:
    struct Slot {
        std::array<std::int32_t, 3> points;  // all but the lowest
        std::array<std::int32_t, 2> places;  // kFaces * cell + face, of the first two
        std::uint32_t count;
    };

    void clear(std::size_t faces) {
        mask_ = std::bit_ceil(2 * faces + 2) - 1;
        if (slots_.size() <= mask_) slots_.resize(mask_ + 1);
        for (std::size_t slot = 0; slot <= mask_; ++slot) slots_[slot].count = 0;
    }

    // The slot of a face, which counts it.
    Slot& add(const std::array<std::int32_t, 4>& points, std::int32_t place) {
        const std::uint64_t sum = static_cast<std::uint32_t>(points[1]) * std::uint64_t{0x9e3779b97f4a7c15} +
                                  static_cast<std::uint32_t>(points[2]) * std::uint64_t{0xd6e8feb86659fd93} +
                                  static_cast<std::uint32_t>(points[3]) * std::uint64_t{0xbf58476d1ce4e5b9};
        for (std::size_t n = sum >> 40 & mask_;; n = (n + 1) & mask_) {
            Slot& slot = slots_[n];
            if (slot.count == 0) slot.points = {points[1], points[2], points[3]};
            if (slot.points[0] != points[1] || slot.points[1] != points[2] || slot.points[2] != points[3]) continue;
            if (slot.count < 2) slot.places[slot.count] = place;
            ++slot.count;
            return slot;
        }
    }

    template <class Visit>
    void for_each(const Visit& visit) const {
        for (std::size_t n = 0; n <= mask_; ++n) {
            if (slots_[n].count > 0) visit(slots_[n]);
        }
    }

  private:
    Array<Slot> slots_;
    std::size_t mask_ = 0;
};

}  // namespace isocore::thinning
