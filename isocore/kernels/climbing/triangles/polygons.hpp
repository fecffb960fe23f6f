// polygons.hpp - Cuts several loops of the same length into triangles at once, by the rules of polygon.hpp: nearly all
// loops are short.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "climbing/triangles/loop_triangles.hpp"
#include "climbing/vectors.hpp"
#include "common/lanes.hpp"

namespace isocore::climbing {

// Instantiated for the lengths from 3 to kLongestOfSeveral.
inline constexpr std::size_t kLongestOfSeveral = 8;

template <std::size_t length>
class Polygons {
  public:
    static constexpr std::size_t kCount = kLanes<float>;
    static constexpr std::size_t kTriangles = length - 2;
    using Triangle = LoopTriangle;

    // Of loop n; faces: those of the box that the corner lies on, a bit each.
    void set(std::size_t n, std::size_t corner, const Spot& place, unsigned faces, std::int32_t vertex) {
        for (std::size_t a = 0; a < 3; ++a) places_[corner][a][n] = place[a];
        faces_[corner][n] = std::bit_cast<float>(std::uint32_t{faces});
        vertices_[corner][n] = vertex;
    }
    Spot place(std::size_t n, std::size_t corner) const {
        return {places_[corner][0][n], places_[corner][1][n], places_[corner][2][n]};
    }
    std::int32_t vertex(std::size_t n, std::size_t corner) const { return vertices_[corner][n]; }

    // Cuts the first `count` loops.
    void cut(std::size_t count);
    std::array<Triangle, kTriangles> triangles(std::size_t n) const;

  private:
    using Numbers = Lanes<float>;
    using Row = std::array<float, kCount>;

    Vector<Numbers> places(std::size_t corner) const {
        const Vector<Row>& at = places_[corner];
        return {Numbers(at[0].data()), Numbers(at[1].data()), Numbers(at[2].data())};
    }

    std::array<Vector<Row>, length> places_{};
    std::array<Row, length> faces_{};
    std::array<std::array<std::int32_t, kCount>, length> vertices_{};
    std::array<std::array<Row, length>, length> apex_;  // of the part between two corners
};

}  // namespace isocore::climbing
