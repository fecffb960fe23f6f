// polygon.hpp - Cuts the loop of a highrice into triangles. A diagonal whose ends share a face of the box could be
// drawn by the neighbour too and is not taken; of the others the cheapest set is found by dynamic programming.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "climbing/triangles/loop_triangles.hpp"
#include "climbing/vectors.hpp"
#include "common/lanes.hpp"

namespace isocore::climbing {

class Polygon {
  public:
    using Triangle = LoopTriangle;

    void resize(std::size_t size) {
        if (corners_.size() < size) make_room(size);
        size_ = size;
    }
    // faces: those of the box that the corner lies on, a bit each.
    void set(std::size_t n, const Spot& place, unsigned faces, std::int32_t vertex) {
        for (std::size_t a = 0; a < 3; ++a) places_[a][n] = place[a];
        corners_[n] = {faces, vertex};
    }
    Spot place(std::size_t n) const { return {places_[0][n], places_[1][n], places_[2][n]}; }
    std::int32_t vertex(std::size_t n) const { return corners_[n].vertex; }

    // Its size() - 2 triangles, until the next time.
    std::span<const Triangle> cut();

  private:
    using Numbers = Lanes<float>;

    void make_room(std::size_t size);
    bool may_join(std::size_t i, std::size_t j) const { return !(corners_[i].faces & corners_[j].faces); }
    Vector<Numbers> places(std::size_t first) const;
    Vector<Numbers> in_all_lanes(std::size_t n) const;
    void cut_ears();
    void find_apex(std::size_t i, std::size_t j);
    void note(std::size_t i, std::size_t j, float cost, std::size_t apex);

    std::size_t size_ = 0, stride_ = 0;
    struct Corner {
        unsigned faces;
        std::int32_t vertex;
    };
    std::vector<Corner> corners_;
    Vector<std::vector<float>> places_;  // of the corners, and room for all lanes
    // Of the part between corners i ... j and the line from i to j: the area of its best triangles, and the corner of
    // the one at that line.
    std::vector<float> cost_;
    std::vector<std::uint16_t> apex_;
    std::vector<LoopPart> parts_;
    std::vector<Triangle> triangles_;
};

}  // namespace isocore::climbing
