// facets.hpp - Triangles, and the squared distances from points to the nearest of several.
//
// Each triangle (a, b, c) has a frame of its own with origin a: u runs along the side from a to b, v across it within
// the triangle's plane, h across the plane. In (u, v) the corners are (0, 0), (length, 0) and (top_u, top_v), with a
// positive top_v:
//
//     v
//     |        (top_u, top_v)
//     |         . ' |            A point's squared distance is h^2, plus 0 if (u, v) lies inside the triangle, or else
//     |  left . '   | right      the least squared distance from (u, v) to one of the three sides.
//     |   . '       |
//     + ' - bottom -+ -- u
//   (0, 0)       (length, 0)
#pragma once

#include <array>
#include <cstddef>

#include "climbing/vectors.hpp"
#include "common/lanes.hpp"

namespace isocore::climbing {

// clear(), add() for each triangle, find_frames(), then any number of squared_distances().
class Facets {
  public:
    static constexpr std::size_t kRoom = 512;  // triangles at most

    std::size_t size() const { return size_; }
    void clear() { size_ = 0; }
    void add(const Spot& a, const Spot& b, const Spot& c);
    void find_frames();

    // Writes to `out` the squared distance from each of `size` points to the nearest of the triangles from `first` to
    // before `first + count`. points: x, y and z of all. They and `out` need room for one register of lanes more; what
    // is written there has no meaning. A triangle without area (NaN in its frame) is passed over: each of its sides is
    // covered by its neighbours' sides.
    void squared_distances(std::size_t first, std::size_t count, const Vector<const float*>& points, std::size_t size,
                           float* out) const;

  private:
    // What is stored of each triangle, by column. Corners and axes are three columns each, x, y and z.
    enum Column : std::size_t {
        kCornerA = 0,
        kCornerB = 3,
        kCornerC = 6,
        kAxisU = 9,
        kAxisV = 12,
        kAxisH = 15,
        kLength = 18,
        kTopU = 19,
        kTopV = 20,
        kPerRight = 21,  // 1 / squared length of the right side
        kPerLeft = 22,   // 1 / squared length of the left side
        kColumns = 23
    };

    Floats in_lanes(std::size_t column, std::size_t first) const { return Floats(columns_[column].data() + first); }
    void find_frames(std::size_t first);
    Floats from_points(std::size_t first, std::size_t count, const Vector<Floats>& points) const;
    float from_point(std::size_t first, std::size_t count, const Vector<Floats>& point) const;
    template <class Get>
    static Floats squared_distances(const Get& get, const Vector<Floats>& points);

    std::size_t size_ = 0;
    std::array<std::array<float, kRoom + kLanes>, kColumns> columns_;  // by column, then by triangle
};

// Inline, as it is called for every triangle.
inline void Facets::add(const Spot& a, const Spot& b, const Spot& c) {
    if (size_ % kLanes == 0) {  // no lane of a register may be uninitialised
        for (std::size_t n = 0; n < 9; ++n) Floats(0.0f).store(columns_[kCornerA + n].data() + size_);
    }
    const std::array<const Spot*, 3> corners{&a, &b, &c};
    for (std::size_t n = 0; n < 9; ++n) columns_[kCornerA + n][size_] = (*corners[n / 3])[n % 3];
    ++size_;
}

}  // namespace isocore::climbing
