// deviation.hpp - How far marching cubes' vertices lie from our surface: each is measured in one box, against the
// triangles of that box. So the true distance is never larger.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

#include "climbing/climb.hpp"
#include "climbing/vectors.hpp"
#include "common/array.hpp"
#include "common/lanes.hpp"

namespace isocore::climbing {

inline void add(Deviation& sum, const Deviation& other) {
    sum.max = std::max(sum.max, other.max);
    sum.sum += other.sum;
    sum.squares += other.squares;
}

// The triangles of a box, prepared for many points.
class Facets {
  public:
    using Numbers = Lanes<double>;
    struct Spots {
        Numbers x, y, z;
    };

    void clear() { count_ = 0; }
    void add(const Point& a, const Point& b, const Point& c) {
        if (corners_[0].size() < count_ + kLanes<double>) {
            for (auto& numbers : corners_) numbers.resize(2 * count_ + kLanes<double>);
            for (auto& numbers : prepared_) numbers.resize(2 * count_ + kLanes<double>);
        }
        for (std::size_t axis = 0; axis < 3; ++axis) {
            corners_[axis][count_] = a[axis];
            corners_[3 + axis][count_] = b[axis];
            corners_[6 + axis][count_] = c[axis];
        }
        ++count_;
    }

    // After the last one was added.
    void prepare() {
        for (auto& numbers : corners_) {  // lanes that are not used hold some triangle too
            for (std::size_t n = count_; n % kLanes<double> != 0; ++n) numbers[n] = numbers[0];
        }
        for (std::size_t n = 0; n < count_; n += kLanes<double>) prepare(n);
    }

    // The squared distances from some spots to the nearest triangle; exact but where several lie below a spot.
    Numbers squared_distances(const Spots& p) const {
        const Numbers infinity(std::numeric_limits<double>::infinity()), zero(0.0);
        Numbers best = infinity;
        for (std::size_t n = 0; n < count_; ++n) {
            const auto above = (zero <= over(kInward, n, p)) & (zero <= over(kInward + 4, n, p)) & (zero <= over(kInward + 8, n, p));
            const Numbers height = over(kHeight, n, p);
            best = least(best, choose(above, height * height * prepared(kSquared, n), infinity));
        }
        if (!(best == infinity).any()) return best;
        Numbers beside = infinity;
        for (std::size_t n = 0; n < count_; ++n) beside = least(beside, to_sides(n, p));
        return choose(best == infinity, beside, best);
    }

  private:
    // What is prepared of a triangle: the planes through it and through its sides, not to scale, and its sides.
    static constexpr std::size_t kHeight = 0, kSquared = 4, kInward = 5, kAlong = 17, kShortened = 26, kNumbers = 29;

    Numbers prepared(std::size_t what, std::size_t n) const { return Numbers(prepared_[what][n]); }
    Numbers over(std::size_t plane, std::size_t n, const Spots& p) const {
        return p.x * prepared(plane, n) + p.y * prepared(plane + 1, n) + p.z * prepared(plane + 2, n) + prepared(plane + 3, n);
    }

    Numbers to_sides(std::size_t n, const Spots& p) const {
        const Numbers zero(0.0), one(1.0);
        Numbers best(std::numeric_limits<double>::infinity());
        for (std::size_t side = 0; side < 3; ++side) {
            const auto corner = [&](std::size_t axis) { return Numbers(corners_[3 * side + axis][n]); };
            const auto along = [&](std::size_t axis) { return prepared(kAlong + 3 * side + axis, n); };
            const Spots from{p.x - corner(0), p.y - corner(1), p.z - corner(2)};
            const Numbers share = (from.x * along(0) + from.y * along(1) + from.z * along(2)) * prepared(kShortened + side, n);
            const Numbers t = least(greatest(share, zero), one);
            const Spots off{from.x - t * along(0), from.y - t * along(1), from.z - t * along(2)};
            best = least(best, off.x * off.x + off.y * off.y + off.z * off.z);
        }
        return best;
    }

    // As many triangles as there are lanes, from the n-th on.
    void prepare(std::size_t n) {
        const Numbers one(1.0), zero(0.0);
        const auto corner = [&](std::size_t c) {
            const auto axis = [&](std::size_t a) { return Numbers(corners_[3 * (c % 3) + a].data() + n); };
            return Spots{axis(0), axis(1), axis(2)};
        };
        const auto minus = [](const Spots& a, const Spots& b) { return Spots{a.x - b.x, a.y - b.y, a.z - b.z}; };
        const auto cross = [](const Spots& a, const Spots& b) {
            return Spots{a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
        };
        const auto dot = [](const Spots& a, const Spots& b) { return a.x * b.x + a.y * b.y + a.z * b.z; };
        const auto set = [&](std::size_t what, const Numbers& value) { value.store(prepared_[what].data() + n); };
        const auto set_spots = [&](std::size_t what, const Spots& value) {
            set(what, value.x);
            set(what + 1, value.y);
            set(what + 2, value.z);
        };
        const auto set_plane = [&](std::size_t what, const Spots& normal, const Spots& through) {
            set_spots(what, normal);
            set(what + 3, zero - dot(normal, through));
        };
        const Spots normal = cross(minus(corner(1), corner(0)), minus(corner(2), corner(0)));
        set_plane(kHeight, normal, corner(0));
        set(kSquared, one / dot(normal, normal));
        for (std::size_t side = 0; side < 3; ++side) {
            const Spots along = minus(corner(side + 1), corner(side));
            set_spots(kAlong + 3 * side, along);
            set_plane(kInward + 4 * side, cross(normal, along), corner(side));
            set(kShortened + side, one / dot(along, along));
        }
    }

    std::size_t count_ = 0;
    std::array<Array<double>, 9> corners_;
    std::array<Array<double>, kNumbers> prepared_;
};

}  // namespace isocore::climbing
