// facets.hpp - The triangles of a box, and how far points lie from the nearest of them.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

#include "climbing/vectors.hpp"
#include "common/lanes.hpp"

namespace isocore::climbing {

// Distances are measured in each triangle's own frame: u runs along its first side, v across it within its plane, h
// across the plane. There its corners are (0, 0), (length, 0) and (u, v) with a positive v.
class Facets {
  public:
    using Numbers = Lanes<float>;
    static constexpr std::size_t kRoom = 512;

    std::size_t size() const { return size_; }
    void clear() { size_ = 0; }

    void add(const Spot& a, const Spot& b, const Spot& c) {
        if (size_ % kLanes<float> == 0) {
            for (std::size_t n = 0; n < 9; ++n) Numbers(0.0f).store(numbers_[kCorners + n].data() + size_);
        }
        const std::array<const Spot*, 3> corners{&a, &b, &c};
        for (std::size_t n = 0; n < 9; ++n) numbers_[kCorners + n][size_] = (*corners[n / 3])[n % 3];
        ++size_;
    }

    // To be called before distances are asked for, when all are added.
    void find_frames() {
        for (std::size_t first = 0; first < size_; first += kLanes<float>) find_frames(first);
    }

    // Writes the squared distances from points to the nearest of `count` triangles from `first` on; what follows them
    // in the room for all lanes is lost, and points must have such room as well. Triangles without area are passed
    // over: their neighbours' sides are theirs.
    void squared_distances(std::size_t first, std::size_t count, const Vector<const float*>& points, std::size_t size,
                           float* out) const {
        const auto registers = [](std::size_t n) { return (n + kLanes<float> - 1) / kLanes<float>; };
        if (size * registers(count) < registers(size) * count) {
            for (std::size_t n = 0; n < size; ++n)
                out[n] = from_point(first, count, {points[0][n], points[1][n], points[2][n]});
        } else {
            for (std::size_t n = 0; n < size; n += kLanes<float>) {
                from_points(first, count, {Numbers(points[0] + n), Numbers(points[1] + n), Numbers(points[2] + n)})
                    .store(out + n);
            }
        }
    }

  private:
    // What is known of triangles: their corners; the axes u, v and h; the corners in that frame; and of the sides from
    // (length, 0) and from (0, 0) to (u, v), one by the squared length.
    static constexpr std::size_t kCorners = 0, kAxes = 9, kLength = 18, kU = 19, kV = 20, kRight = 21, kLeft = 22,
                                 kNumbers = 23;

    // From several points, triangle by triangle.
    Numbers from_points(std::size_t first, std::size_t count, const Vector<Numbers>& points) const {
        Numbers best(std::numeric_limits<float>::infinity());
        for (std::size_t n = first; n < first + count; ++n)
            best = least(best, squared_distances([&](std::size_t what) { return Numbers(numbers_[what][n]); }, points));
        return best;
    }
    // The same bits from one point, several triangles at once.
    float from_point(std::size_t first, std::size_t count, const Vector<Numbers>& point) const {
        const Numbers infinity(std::numeric_limits<float>::infinity());
        Numbers best = infinity;
        for (std::size_t n = 0; n < count; n += kLanes<float>) {
            const Numbers to_each =
                squared_distances([&](std::size_t what) { return in_lanes(what, first + n); }, point);
            best = least(best, first_lanes(to_each, std::min(kLanes<float>, count - n), infinity));
        }
        return best.least_lane();
    }
    Numbers in_lanes(std::size_t what, std::size_t first) const { return Numbers(numbers_[what].data() + first); }

    // number(what): of one triangle, or of several.
    template <class Number>
    static Numbers squared_distances(const Number& number, const Vector<Numbers>& points) {
        const auto vector = [&](std::size_t what) -> Vector<Numbers> {
            return {number(what), number(what + 1), number(what + 2)};
        };
        const auto squared = [](const Numbers& a, const Numbers& b) { return a * a + b * b; };
        const auto in_unit = [](const Numbers& a) { return least(Numbers(1.0f), greatest(Numbers(0.0f), a)); };
        const Numbers zero(0.0f), length = number(kLength), side_u = number(kU), side_v = number(kV),
                                  base = side_u - length;
        const auto from_corner = minus(points, vector(kCorners));
        const Numbers u = dot(from_corner, vector(kAxes)), v = dot(from_corner, vector(kAxes + 3)),
                      h = dot(from_corner, vector(kAxes + 6)), beyond = u - length, rise = v * side_v;
        const Numbers t = in_unit((beyond * base + rise) * number(kRight)),
                      s = in_unit((u * side_u + rise) * number(kLeft));
        const Numbers bottom = squared(u - least(length, greatest(zero, u)), v),
                      right = squared(beyond - t * base, v - t * side_v),
                      left = squared(u - s * side_u, v - s * side_v);
        const auto inside = (zero <= v) & (beyond * side_v <= v * base) & (v * side_u <= u * side_v);
        return h * h + choose(inside, zero, least(bottom, least(right, left)));
    }

    // From where the corners are to all else. Triangles may be a thousand times longer than wide: then the first try at
    // what is across the first side is not quite, and the second is.
    void find_frames(std::size_t first) {
        const auto corner = [&](std::size_t c) -> Vector<Numbers> {
            return {in_lanes(kCorners + 3 * c, first), in_lanes(kCorners + 3 * c + 1, first),
                    in_lanes(kCorners + 3 * c + 2, first)};
        };
        const auto a = corner(0), bottom = minus(corner(1), a), left = minus(corner(2), a);
        const Numbers one(1.0f), length = root(dot(bottom, bottom));
        const auto along = times(one / length, bottom);
        const Numbers u = dot(left, along);
        const auto first_try = minus(left, times(u, along)),
                   rise = minus(first_try, times(dot(first_try, along), along));
        const Numbers v = root(dot(rise, rise));
        const auto across = times(one / v, rise);
        const auto set = [&](std::size_t what, const Numbers& numbers) {
            numbers.store(numbers_[what].data() + first);
        };
        const std::array<Vector<Numbers>, 3> axes{along, across, cross(along, across)};
        for (std::size_t n = 0; n < 9; ++n) set(kAxes + n, axes[n / 3][n % 3]);
        set(kLength, length);
        set(kU, u);
        set(kV, v);
        set(kRight, one / (v * v + (u - length) * (u - length)));
        set(kLeft, one / (v * v + u * u));
    }

    std::size_t size_ = 0;
    std::array<std::array<float, kRoom + kLanes<float>>, kNumbers> numbers_;  // set as far as there are triangles
};

}  // namespace isocore::climbing
