// join_points.cpp - Points at equal coordinates, in one pass. Slots of the table are asked for some points ahead.
#include "joining/join_points.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "joining/join_near.hpp"
#include "joining/table.hpp"

namespace isocore {
namespace {

// Where hardly any of so many points coincide with others, none of the rest may, and the table need not grow in steps.
constexpr std::size_t kSample = std::size_t{1} << 15;

// Where points are joined, the places of those that are left lie together, in the order in which they are met.
class Places {
  public:
    Places(const double* points, const Array<std::int32_t>& first) : points_(points), first_(first) {}

    // From here on nothing is kept: the points themselves are looked at.
    void leave() {
        own_ = false;
        places_ = {};
    }

    void add(const Place& place) {
        if (own_) places_.push_back(place);
    }

    Place operator[](std::int32_t number) const {
        const auto at = static_cast<std::size_t>(number);
        return own_ ? places_[at] : place_of(points_, static_cast<std::size_t>(first_[at]));
    }

    bool same(const Place& place, std::int32_t number) const {
        const Place other = (*this)[number];
        return (place[0] == other[0]) & (place[1] == other[1]) & (place[2] == other[2]);
    }

  private:
    const double* points_;
    const Array<std::int32_t>& first_;
    std::vector<Place> places_;
    bool own_ = true;
};

JoinedPoints join_equal(const double* points, std::size_t count) {
    constexpr std::size_t kAtOnce = 64;
    JoinedPoints result{large_array<std::int32_t>(count), {}};
    Places places(points, result.first);
    Table table(std::min(count, kSample));
    const auto hash_of = [&](std::int32_t number) { return hash(places[number]); };
    std::array<std::uint32_t, kAtOnce> hashes;
    for (std::size_t first = 0; first < count; first += kAtOnce) {
        if (first == kSample && result.first.size() > kSample / 8 * 7) {
            table.make_room(count, hash_of);
            places.leave();
        }
        const std::size_t some = std::min(kAtOnce, count - first), left = result.first.size();
        if (!table.has_room(left + some)) table.make_room(2 * (left + some), hash_of);
        for (std::size_t n = 0; n < some; ++n) {
            hashes[n] = hash(place_of(points, first + n));
            table.prefetch(hashes[n]);
        }
        for (std::size_t n = 0; n < some; ++n) {
            const std::size_t point = first + n;
            const Place place = place_of(points, point);
            const auto next = static_cast<std::int32_t>(result.first.size());
            const std::int32_t number =
                table.find_or_enter(hashes[n], next, [&](std::int32_t other) { return places.same(place, other); });
            if (number == next) {
                result.first.push_back(static_cast<std::int32_t>(point));
                places.add(place);
            }
            result.number[point] = number;
        }
    }
    return result;
}

}  // namespace

JoinedPoints join_points(const double* points, std::size_t count, double distance) {
    if (count > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
        throw std::length_error("a mesh has at most 2^31 - 1 points");
    }
    double farthest = 0;
    for (std::size_t n = 0; distance > 0 && n < 3 * count; ++n) farthest = std::max(farthest, std::abs(points[n]));
    // Where the distance is below the coordinates' own steps only equal points lie within it.
    if (!(distance > 0x1p-52 * farthest)) return join_equal(points, count);
    return join_near(points, count, distance);
}

}  // namespace isocore
