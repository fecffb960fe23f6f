// faces.hpp - Faces of cells by their points, and which of those at one point are the same.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "common/array.hpp"
#include "common/inlined.hpp"
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

template <class Number>
void order(Number& a, Number& b) {
    const Number low = std::min(a, b);
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

// Calls visit(face, points) for the faces of a cell that have its lowest point, or for those that have not.
template <class Visit>
ISOCORE_INLINED void for_faces(mesh::Tet, const std::int32_t* ids, bool with_lowest, const Visit& visit) {
    std::array<std::uint64_t, 4> corners;  // the point, then which corner it is
    for (std::size_t n = 0; n < 4; ++n) corners[n] = std::uint64_t{static_cast<std::uint32_t>(ids[n])} << 2 | n;
    for (const auto& [a, b] :
         {std::array{0, 1}, std::array{2, 3}, std::array{0, 2}, std::array{1, 3}, std::array{1, 2}})
        order(corners[static_cast<std::size_t>(a)], corners[static_cast<std::size_t>(b)]);
    const auto point = [&](std::size_t n) { return static_cast<std::int32_t>(corners[n] >> 2); };
    const auto opposite = [&](std::size_t n) { return static_cast<std::size_t>(corners[n] & 3); };
    if (!with_lowest) return visit(opposite(0), std::array{point(1), point(2), point(3), 0});
    visit(opposite(1), std::array{point(0), point(2), point(3), 0});
    visit(opposite(2), std::array{point(0), point(1), point(3), 0});
    visit(opposite(3), std::array{point(0), point(1), point(2), 0});
}

template <class Visit>
void for_faces(mesh::Hex, const std::int32_t* ids, bool with_lowest, const Visit& visit) {
    const mesh::Mask others = kOpposite<mesh::Hex>[lowest_corner<mesh::Hex>(ids)];
    for (mesh::Mask left = with_lowest ? ~others & 0x3f : others; left != 0; left &= left - 1) {
        const auto face = static_cast<std::size_t>(std::countr_zero(left));
        visit(face, named_points(mesh::Hex{}, ids, face));
    }
}

// The faces seen at one point, in a hash table with room for twice as many. What was used of it is listed, so that it
// is looked at and emptied without a look at the rest.
class Matcher {
  public:
    struct Slot {
        std::array<std::int32_t, 3> points;  // all but the lowest
        std::array<std::int32_t, 2> places;  // kFaces * cell + face, of the first two
        std::uint32_t count;
    };

    // Empties it, and makes room for as many faces.
    void clear(std::size_t faces) {
        for (std::size_t n = 0; n < used_; ++n) slots_[order_[n]].count = 0;
        used_ = 0;
        mask_ = std::bit_ceil(2 * faces + 2) - 1;
        if (mask_ < slots_.size()) return;
        slots_.assign(mask_ + 1, Slot{});
        order_.resize(mask_ + 1);
    }

    // The slot of a face, which counts it.
    ISOCORE_INLINED Slot& add(const std::array<std::int32_t, 4>& points, std::int32_t place) {
        const std::uint64_t sum = static_cast<std::uint32_t>(points[1]) * std::uint64_t{0x9e3779b97f4a7c15} +
                                  static_cast<std::uint32_t>(points[2]) * std::uint64_t{0xd6e8feb86659fd93} +
                                  static_cast<std::uint32_t>(points[3]) * std::uint64_t{0xbf58476d1ce4e5b9};
        for (std::size_t n = sum >> 40 & mask_;; n = (n + 1) & mask_) {
            Slot& slot = slots_[n];
            if (slot.count == 0) {
                slot = {{points[1], points[2], points[3]}, {place, -1}, 1};
                order_[used_++] = static_cast<std::uint32_t>(n);
                return slot;
            }
            if (slot.points[0] != points[1] || slot.points[1] != points[2] || slot.points[2] != points[3]) continue;
            if (slot.count == 1) slot.places[1] = place;
            ++slot.count;
            return slot;
        }
    }

    // In the order in which the faces came.
    template <class Visit>
    void for_each(const Visit& visit) const {
        for (std::size_t n = 0; n < used_; ++n) visit(slots_[order_[n]]);
    }

  private:
    Array<Slot> slots_;
    Array<std::uint32_t> order_;  // the slots in use
    std::size_t mask_ = 0, used_ = 0;
};

}  // namespace isocore::thinning
