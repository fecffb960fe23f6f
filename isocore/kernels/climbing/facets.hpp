// facets.hpp - The triangles of a box, and how far points lie from the nearest of them.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <vector>

#include "climbing/vectors.hpp"
#include "common/lanes.hpp"

namespace isocore::climbing {

// Distances are measured in each triangle's own frame: u runs along its first side, v across it within its plane, h across
// the plane. There its corners are (0, 0), (length, 0) and (u, v) with a positive v.
class Facets {
  public:
    using Numbers = Lanes<float>;

    // corner(t, c) is corner c of triangle t.
    template <class Corner>
    void take(std::size_t count, const Corner& corner) {
        size_ = count;
        if (frames_.size() * kLanes<float> < count) frames_.resize(2 * count);
        for (std::size_t first = 0; first < count; first += kLanes<float>) {
            Frames& frames = frames_[first / kLanes<float>];
            for (std::size_t n = 0; n < std::min(kLanes<float>, count - first); ++n) {
                for (std::size_t c = 0; c < 3; ++c) {
                    const Spot place = corner(first + n, c);
                    for (std::size_t a = 0; a < 3; ++a) frames[kCorners + 3 * c + a][n] = place[a];
                }
            }
            find_frames(frames);
        }
    }

    // The squared distances of the first `count` points to the nearest triangle, and 0 in the other lanes. Triangles without
    // area are passed over: their neighbours' sides are theirs.
    Numbers squared_distances(const Vector<Numbers>& points, std::size_t count) const {
        return count < size_ && size_ <= kLanes<float> ? point_by_point(points, count) : first_lanes(triangle_by_triangle(points), count, 0.0f);
    }

  private:
    // What is known of as many triangles as there are lanes: their corners; the axes u, v and h; the corners in that frame; and
    // of the sides from (length, 0) and from (0, 0) to (u, v), one by the squared length.
    static constexpr std::size_t kCorners = 0, kAxes = 9, kLength = 18, kU = 19, kV = 20, kRight = 21, kLeft = 22, kNumbers = 23;
    using Frames = std::array<std::array<float, kLanes<float>>, kNumbers>;

    Numbers triangle_by_triangle(const Vector<Numbers>& points) const {
        Numbers best(std::numeric_limits<float>::infinity());
        for (std::size_t n = 0; n < size_; ++n) {
            const Frames& frames = frames_[n / kLanes<float>];
            best = least(best, squared_distances([&](std::size_t what) { return Numbers(frames[what][n % kLanes<float>]); }, points));
        }
        return best;
    }

    // The same bits, if there are no more triangles than lanes.
    Numbers point_by_point(const Vector<Numbers>& points, std::size_t count) const {
        const Numbers infinity(std::numeric_limits<float>::infinity());
        const auto x = points[0].each(), y = points[1].each(), z = points[2].each();
        std::array<float, kLanes<float>> found{};
        for (std::size_t n = 0; n < count; ++n) {
            const Numbers to_each = squared_distances([&](std::size_t what) { return Numbers(frames_[0][what].data()); }, {x[n], y[n], z[n]});
            found[n] = least(infinity, first_lanes(to_each, size_, infinity)).least_lane();
        }
        return Numbers(found.data());
    }

    // number(what): of one triangle or several, for points or a point in all lanes.
    template <class Number>
    static Numbers squared_distances(const Number& number, const Vector<Numbers>& points) {
        const auto vector = [&](std::size_t what) -> Vector<Numbers> { return {number(what), number(what + 1), number(what + 2)}; };
        const auto from_corner = minus(points, vector(kCorners));
        const auto squared = [](const Numbers& a, const Numbers& b) { return a * a + b * b; };
        const auto in_unit = [](const Numbers& a) { return least(Numbers(1.0f), greatest(Numbers(0.0f), a)); };
        const Numbers zero(0.0f), length = number(kLength), side_u = number(kU), side_v = number(kV), base = side_u - length;
        const Numbers u = dot(from_corner, vector(kAxes)), v = dot(from_corner, vector(kAxes + 3)), h = dot(from_corner, vector(kAxes + 6)), beyond = u - length, rise = v * side_v;
        const Numbers t = in_unit((beyond * base + rise) * number(kRight)), s = in_unit((u * side_u + rise) * number(kLeft));
        const Numbers bottom = squared(u - least(length, greatest(zero, u)), v), right = squared(beyond - t * base, v - t * side_v),
                      left = squared(u - s * side_u, v - s * side_v);
        const auto inside = (zero <= v) & (beyond * side_v <= v * base) & (v * side_u <= u * side_v);
        return h * h + choose(inside, zero, least(bottom, least(right, left)));
    }

    // From where the corners are to all else. Triangles may be a thousand times longer than wide: then the first try at what
    // is across the first side is not quite, and the second is.
    static void find_frames(Frames& frames) {
        const auto corner = [&](std::size_t c) -> Vector<Numbers> {
            const auto* from = &frames[kCorners + 3 * c];
            return {Numbers(from[0].data()), Numbers(from[1].data()), Numbers(from[2].data())};
        };
        const auto a = corner(0), bottom = minus(corner(1), a), left = minus(corner(2), a);
        const Numbers one(1.0f), length = root(dot(bottom, bottom));
        const auto along = times(one / length, bottom);
        const Numbers u = dot(left, along);
        const auto first_try = minus(left, times(u, along)), rise = minus(first_try, times(dot(first_try, along), along));
        const Numbers v = root(dot(rise, rise));
        const auto across = times(one / v, rise);
        const auto set = [&](std::size_t what, const Numbers& numbers) { numbers.store(frames[what].data()); };
        const std::array<Vector<Numbers>, 3> axes{along, across, cross(along, across)};
        for (std::size_t n = 0; n < 9; ++n) set(kAxes + n, axes[n / 3][n % 3]);
        set(kLength, length);
        set(kU, u);
        set(kV, v);
        set(kRight, one / (v * v + (u - length) * (u - length)));
        set(kLeft, one / (v * v + u * u));
    }

    std::size_t size_ = 0;
    std::vector<Frames> frames_;
};

}  // namespace isocore::climbing
