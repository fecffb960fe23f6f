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

#include "common/lanes.hpp"
#include "common/vectors.hpp"

namespace isocore {

// clear(), add() for each triangle, find_frames(), then any number of squared_distances().
class Facets {
  public:
    static constexpr std::size_t kRoom = 512;  // triangles at most

    std::size_t size() const { return size_; }
    void clear() { size_ = 0; }
    void add(const Spot& a, const Spot& b, const Spot& c);
    // Up to eight at once, where a multiple of eight were added before: the first `count` lanes.
    void add(const std::array<Vector<Floats>, 3>& corners, std::size_t count);
    void find_frames();

    // Writes to `out` the squared distance from each of `size` points to the nearest of the triangles from `first` to
    // before `first + count`. points: x, y and z of all. They and `out` need room for one register of lanes more; what
    // is written there has no meaning. A triangle without area (NaN in its frame) is passed over: each of its sides is
    // covered by its neighbours' sides.
    void squared_distances(std::size_t first, std::size_t count, const Vector<const float*>& points, std::size_t size,
                           float* out) const;
    // The squared distances from eight points, one in each lane, to one triangle.
    Floats from_points(std::size_t triangle, const Vector<Floats>& points) const {
        return squared_distances([&](std::size_t column) { return Floats(columns_[column][triangle]); }, points);
    }
    // The squared distances from one point, the same in all lanes, to the triangles from `first` on, one in each lane.
    // `first` is a multiple of the number of lanes; what comes out for triangles that were not added has no meaning.
    Floats from_point(std::size_t first, const Vector<Floats>& point) const {
        return squared_distances([&](std::size_t column) { return in_lanes(column, first); }, point);
    }

    // A triangle's frame, as drawn above.
    struct Frame {
        Spot origin, u, v, h;
        float length, top_u, top_v;
    };
    Frame frame(std::size_t triangle) const;

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
    // get(column): of one triangle in all lanes, or of one triangle in each.
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

inline void Facets::add(const std::array<Vector<Floats>, 3>& corners, std::size_t count) {
    for (std::size_t n = 0; n < 9; ++n) corners[n / 3][n % 3].store(columns_[kCornerA + n].data() + size_);
    size_ += count;
}

// Inline, as simplification calls it for a few points at a time.
template <class Get>
inline auto Facets::squared_distances(const Get& get, const Vector<Floats>& points) -> Floats {
    const auto vector = [&](std::size_t column) -> Vector<Floats> {
        return {get(column), get(column + 1), get(column + 2)};
    };
    const auto squared = [](const Floats& a, const Floats& b) { return a * a + b * b; };
    const auto clamped = [](const Floats& a) { return least(Floats(1.0f), greatest(Floats(0.0f), a)); };
    const Floats zero(0.0f), length = get(kLength), top_u = get(kTopU), top_v = get(kTopV), base = top_u - length;
    const auto from_corner = minus(points, vector(kCornerA));
    const Floats u = dot(from_corner, vector(kAxisU)), v = dot(from_corner, vector(kAxisV)),
                 h = dot(from_corner, vector(kAxisH)), beyond = u - length, rise = v * top_v;
    // t and s: how far along the right and the left side, from 0 at the bottom to 1 at the top, the nearest point is.
    const Floats t = clamped((beyond * base + rise) * get(kPerRight)), s = clamped((u * top_u + rise) * get(kPerLeft));
    const Floats bottom = squared(u - least(length, greatest(zero, u)), v),
                 right = squared(beyond - t * base, v - t * top_v), left = squared(u - s * top_u, v - s * top_v);
    const auto inside = (zero <= v) & (beyond * top_v <= v * base) & (v * top_u <= u * top_v);
    return h * h + choose(inside, zero, least(bottom, least(right, left)));
}

}  // namespace isocore
