// patch.hpp - Some of the reference's triangles, copied close together, coordinate by coordinate. Places are relative
// to a vertex of the mesh, and stretched; or seen from a triangle: along its first side, across it, and above it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/facets.hpp"
#include "common/lanes.hpp"
#include "simplification/reference.hpp"
#include "simplification/rows.hpp"

namespace isocore::simplification {

struct Box {
    Spot low, high;

    static Box around(const std::array<Spot, 3>& triangle, float margin);
    void add(const Box& other);
};

class Patch {
  public:
    std::size_t size() const { return size_; }
    // Takes all triangles of a sheet in cells that touch a box around `origin`, each once; from the rows, if they cover
    // it.
    template <class Real>
    void gather(const Reference<Real>& reference, Rows& rows, const Mesh<Real>& mesh, const std::array<Real, 3>& origin,
                const Box& box, std::uint32_t sheet);
    // Takes those of another patch, or of this one, whose boxes touch this one.
    void select(const Patch& from, const Box& box);
    // Takes those of another patch of which a point may lie within the margin of a triangle with this box, a margin
    // included, and this frame. Their places are then those that they have in the frame.
    void select(const Patch& from, const Box& box, const Facets::Frame& frame, float margin);

    // Corner `corner` of eight triangles from `first` on. Lanes past the last triangle hold corners far away.
    Vector<Floats> in_lanes(std::size_t corner, std::size_t first) const {
        const auto lanes = [&](std::size_t a) { return Floats(column(3 * corner + a) + first); };
        return {lanes(0), lanes(1), lanes(2)};
    }
    Spot corner(std::size_t triangle, std::size_t n) const {
        return {column(3 * n)[triangle], column(3 * n + 1)[triangle], column(3 * n + 2)[triangle]};
    }
    // Of eight triangles from `first` on: a bit for each that may have a side on the reference's border.
    unsigned at_border(std::size_t first) const { return (Floats(0.0f) < Floats(column(kBorder) + first)).bits(); }

  private:
    static constexpr std::size_t kBorder = 9, kColumns = 10;

    void gather_rows(const Reference<float>& reference, Rows& rows, const Mesh<float>& mesh,
                     const std::array<float, 3>& origin, const Cell& low, const Cell& high);
    template <class Real>
    void find(const Reference<Real>& reference, const Cell& low, const Cell& high, std::uint32_t sheet);
    void make_room(std::size_t size);
    std::size_t make_room_for(const Patch& from);
    void end();
    unsigned touching(std::size_t first, const Box& box) const;
    // Which of eight triangles from `first` on there are, of so many.
    static unsigned valid(std::size_t first, std::size_t count) {
        return count - first < kLanes ? (1u << (count - first)) - 1 : 255u;
    }

    std::size_t size_ = 0;
    const float* column(std::size_t number) const { return numbers_.data() + number * room_; }
    float* column(std::size_t number) { return numbers_.data() + number * room_; }

    std::size_t room_ = 0;        // of a column
    std::vector<float> numbers_;  // column by column
    Array<std::int32_t> found_;   // triangles of the reference
};

}  // namespace isocore::simplification
