// polygons.hpp - Triangulates several loops of one length at once, a loop in each lane, by the rules of polygon.hpp:
// nearly all loops are short.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "climbing/triangles/loop_triangles.hpp"
#include "common/lanes.hpp"
#include "common/vectors.hpp"

namespace isocore::climbing {

// Polygons is instantiated for the lengths from 3 to this one.
inline constexpr std::size_t kLongestOfSeveral = 8;

// set() for each corner of each loop, triangulate(), then triangles(n) for each loop.
template <std::size_t length>
class Polygons {
  public:
    static constexpr std::size_t kCount = kLanes;          // loops at once
    static constexpr std::size_t kTriangles = length - 2;  // of each loop
    using Triangle = LoopTriangle;

    // Sets a corner of loop n. faces: the faces of the loop's box that the corner lies on, a bit each.
    void set(std::size_t n, std::size_t corner, const Spot& place, unsigned faces, std::int32_t vertex) {
        for (std::size_t a = 0; a < 3; ++a) places_[corner][a][n] = place[a];
        faces_[corner][n] = std::bit_cast<float>(std::uint32_t{faces});
        vertices_[corner][n] = vertex;
    }
    // Sets where the samples fall at a corner; to be called for every corner, if triangles are to be tilted little.
    void set_direction(std::size_t n, std::size_t corner, const Spot& direction) {
        for (std::size_t a = 0; a < 3; ++a) directions_[corner][a][n] = direction[a];
    }
    Spot place(std::size_t n, std::size_t corner) const {
        return {places_[corner][0][n], places_[corner][1][n], places_[corner][2][n]};
    }
    std::int32_t vertex(std::size_t n, std::size_t corner) const { return vertices_[corner][n]; }

    // Triangulates the first `count` loops. tilted: by tilt, too. Throws std::logic_error if one of them cannot be.
    void triangulate(std::size_t count, bool tilted);
    // The triangles of loop n, as corner numbers in the loop's sense.
    std::array<Triangle, kTriangles> triangles(std::size_t n) const;

  private:
    using PerLoop = std::array<float, kCount>;

    template <bool tilted>
    void triangulate_all(std::size_t count);
    static Vector<Floats> in_lanes(const Vector<PerLoop>& at) {
        return {Floats(at[0].data()), Floats(at[1].data()), Floats(at[2].data())};
    }
    Vector<Floats> places(std::size_t corner) const { return in_lanes(places_[corner]); }
    Vector<Floats> falls(std::size_t i, std::size_t j, std::size_t k) const {
        return plus(plus(in_lanes(directions_[i]), in_lanes(directions_[j])), in_lanes(directions_[k]));
    }

    std::array<Vector<PerLoop>, length> places_{}, directions_{};  // by corner
    std::array<PerLoop, length> faces_{};                          // by corner; integers in a float's bits
    std::array<std::array<std::int32_t, kCount>, length> vertices_{};
    std::array<std::array<PerLoop, length>, length> apex_;  // apex_[i][j]: of part (i, j), see loop_triangles.hpp
};

}  // namespace isocore::climbing
