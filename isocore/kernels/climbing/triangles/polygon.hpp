// polygon.hpp - Triangulates the loop of a highrice: the set of triangles of least total cost (loop_cost.hpp), found by
// dynamic programming over the parts of the loop. A diagonal whose two ends share a face of the box is not taken, as
// the neighbour behind that face could draw it too. Any length; polygons.hpp does the same for several short loops at
// once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "climbing/triangles/loop_triangles.hpp"
#include "common/lanes.hpp"
#include "common/vectors.hpp"

namespace isocore::climbing {

// resize(), set() for each corner in the loop's order, then triangulate().
class Polygon {
  public:
    using Triangle = LoopTriangle;

    void resize(std::size_t size) {
        if (corners_.size() < size) make_room(size);
        size_ = size;
    }
    // faces: the faces of the box that the corner lies on, a bit each. vertex: any number, given back by vertex(n).
    void set(std::size_t n, const Spot& place, unsigned faces, std::int32_t vertex) {
        for (std::size_t a = 0; a < 3; ++a) places_[a][n] = place[a];
        corners_[n] = {faces, vertex};
    }
    // Sets where the samples fall at a corner; to be called for every corner, if triangles are to be tilted little.
    void set_direction(std::size_t n, const Spot& direction) {
        for (std::size_t a = 0; a < 3; ++a) directions_[a][n] = direction[a];
    }
    Spot place(std::size_t n) const { return {places_[0][n], places_[1][n], places_[2][n]}; }
    std::int32_t vertex(std::size_t n) const { return corners_[n].vertex; }

    // The size - 2 triangles, as corner numbers in the loop's sense; valid until the next call. tilted: by tilt, too.
    // Throws std::logic_error if every triangulation has a diagonal that may not be taken.
    std::span<const Triangle> triangulate(bool tilted);

  private:
    struct Corner {
        unsigned faces;
        std::int32_t vertex;
    };

    void make_room(std::size_t size);
    bool may_join(std::size_t i, std::size_t j) const { return !(corners_[i].faces & corners_[j].faces); }
    // A corner in each lane.
    struct Corners {
        Vector<Floats> places, directions;
    };
    Corners corners(std::size_t first) const;
    Corners in_all_lanes(std::size_t n) const;
    Floats costs(const Corners& a, const Corners& b, const Corners& c) const;
    void cut_ears();
    void find_apex(std::size_t i, std::size_t j);
    void note(std::size_t i, std::size_t j, float cost, std::size_t apex);

    std::size_t size_ = 0, stride_ = 0;
    std::vector<Corner> corners_;
    Vector<std::vector<float>> places_, directions_;  // x, y, z at the corners, each padded by one register of lanes
    bool tilted_ = false;
    // The solved parts (i, j), at i * stride + j: the least cost of their triangles, also at j * stride + i, and the
    // apex of the triangle on the line from i to j.
    std::vector<float> cost_;
    std::vector<std::uint16_t> apex_;
    std::vector<LoopPart> parts_;  // scratch of list_triangles
    std::vector<Triangle> triangles_;
};

}  // namespace isocore::climbing
