// deviation.hpp - How far marching cubes' vertices lie from our surface: each is measured in one box, against the
// triangles of that box. So the true distance is never larger.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "climbing/climb.hpp"
#include "climbing/vectors.hpp"
#include "common/lanes.hpp"

namespace isocore::climbing {

inline void add(Deviation& sum, const Deviation& other) {
    sum.max = std::max(sum.max, other.max);
    sum.sum += other.sum;
    sum.squares += other.squares;
}

// Adds one distance, given squared, and returns it.
inline double add(Deviation& sum, double squared) {
    const double distance = std::sqrt(squared);
    sum.max = std::max(sum.max, distance);
    sum.sum += distance;
    sum.squares += squared;
    return distance;
}

// The triangles of a box, as many at once as there are lanes.
class Facets {
  public:
    // corner(t, c) is corner c of triangle t.
    template <class Corner>
    void take(std::size_t count, const Corner& corner) {
        used_ = (count + kLanes<double> - 1) / kLanes<double>;
        if (groups_.size() < used_) groups_.resize(2 * used_);
        for (std::size_t n = 0; n < used_ * kLanes<double>; ++n) {
            for (std::size_t c = 0; c < 3; ++c) {
                const Point place = corner(n < count ? n : 0, c);  // lanes that are left over take the first one
                for (std::size_t a = 0; a < 3; ++a) groups_[n / kLanes<double>][kCorners + 3 * c + a][n % kLanes<double>] = place[a];
            }
        }
        for (std::size_t g = 0; g < used_; ++g) prepare(groups_[g]);
    }

    // The squared distance from a point to the nearest triangle; exact but where several lie below it.
    double squared_distance(const Point& point) const {
        const Spots p{Numbers(point[0]), Numbers(point[1]), Numbers(point[2])};
        const Numbers infinity(std::numeric_limits<double>::infinity()), zero(0.0);
        Numbers best = infinity;
        for (std::size_t g = 0; g < used_; ++g) {
            const Group& group = groups_[g];
            const auto above = (zero <= over(group, kInward, p)) & (zero <= over(group, kInward + 4, p)) & (zero <= over(group, kInward + 8, p));
            const Numbers height = over(group, kHeight, p);
            best = least(best, choose(above, height * height * numbers(group, kSquared), infinity));
        }
        if ((best < infinity).any()) return least_of(best);
        for (std::size_t g = 0; g < used_; ++g) best = least(best, to_sides(groups_[g], p));
        return least_of(best);
    }

  private:
    using Numbers = Lanes<double>;
    struct Spots {
        Numbers x, y, z;
    };

    // What is known of a triangle: the planes through it and through its sides, not to scale, its sides and its corners.
    static constexpr std::size_t kHeight = 0, kSquared = 4, kInward = 5, kAlong = 17, kShortened = 26, kCorners = 29, kNumbers = 38;
    using Group = std::array<std::array<double, kLanes<double>>, kNumbers>;

    static Numbers numbers(const Group& group, std::size_t what) { return Numbers(group[what].data()); }
    static Spots spots(const Group& group, std::size_t what) { return {numbers(group, what), numbers(group, what + 1), numbers(group, what + 2)}; }
    static Numbers over(const Group& group, std::size_t plane, const Spots& p) { return dot(p, spots(group, plane)) + numbers(group, plane + 3); }

    static double least_of(const Numbers& numbers) {
        const auto each = numbers.each();
        return *std::min_element(each.begin(), each.end());
    }

    static Spots minus(const Spots& a, const Spots& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
    static Spots cross(const Spots& a, const Spots& b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
    static Numbers dot(const Spots& a, const Spots& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

    static Numbers to_sides(const Group& group, const Spots& p) {
        const Numbers zero(0.0), one(1.0);
        Numbers best(std::numeric_limits<double>::infinity());
        for (std::size_t side = 0; side < 3; ++side) {
            const Spots from = minus(p, spots(group, kCorners + 3 * side)), along = spots(group, kAlong + 3 * side);
            const Numbers t = least(greatest(dot(from, along) * numbers(group, kShortened + side), zero), one);
            const Spots off = minus(from, {t * along.x, t * along.y, t * along.z});
            best = least(best, dot(off, off));
        }
        return best;
    }

    // From the corners to all else.
    static void prepare(Group& group) {
        const Numbers one(1.0), zero(0.0);
        const auto set = [&](std::size_t what, const Numbers& value) { value.store(group[what].data()); };
        const auto set_spots = [&](std::size_t what, const Spots& value) {
            set(what, value.x);
            set(what + 1, value.y);
            set(what + 2, value.z);
        };
        const auto set_plane = [&](std::size_t what, const Spots& normal, const Spots& through) {
            set_spots(what, normal);
            set(what + 3, zero - dot(normal, through));
        };
        const std::array<Spots, 3> corners{spots(group, kCorners), spots(group, kCorners + 3), spots(group, kCorners + 6)};
        const Spots normal = cross(minus(corners[1], corners[0]), minus(corners[2], corners[0]));
        set_plane(kHeight, normal, corners[0]);
        set(kSquared, one / dot(normal, normal));
        for (std::size_t side = 0; side < 3; ++side) {
            const Spots along = minus(corners[(side + 1) % 3], corners[side]);
            set_spots(kAlong + 3 * side, along);
            set_plane(kInward + 4 * side, cross(normal, along), corners[side]);
            set(kShortened + side, one / dot(along, along));
        }
    }

    std::size_t used_ = 0;
    std::vector<Group> groups_;
};

}  // namespace isocore::climbing
