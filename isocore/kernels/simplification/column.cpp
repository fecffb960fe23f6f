#include "simplification/column.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace isocore::simplification {
namespace {

// Distances below this, in cells, are not told apart: some times what rounding does to places a few cells away.
constexpr float kBlur = 1e-5f;
constexpr float kTilt = 1e-3f;  // what rounding does to a plane's height a cell away, at most
constexpr float kFar = 1e9f;    // what lanes past the end hold

}  // namespace

bool Column::is_covered(const std::array<Spot, 3>& triangle, const Patch& patch, float limit) {
    build_walls(triangle);
    limit_ = limit;
    count_ = 0;
    distance_ = 0;
    if (places_[0].size() < patch.size() + 2 * kLanes) {
        for (auto& column : places_) column.resize(2 * patch.size() + 2 * kLanes);
    }
    for (std::size_t first = 0; first < patch.size(); first += kLanes) {
        if (!add_parts(patch, first)) return false;
    }
    for (auto& column : places_) Floats(kFar).store(column.data() + count_);
    // One point is as good as another, unless a side of the reference passes too close to it.
    return is_odd_at(0.37f, 0.29f) || is_odd_at(0.31f, 0.36f);
}

void Column::build_walls(const std::array<Spot, 3>& triangle) {
    extent_ = 0;
    for (std::size_t n = 0; n < 3; ++n) {
        const Spot &from = triangle[n], &to = triangle[n == 2 ? 0 : n + 1];
        const float along = to[0] - from[0], across = to[1] - from[1];
        walls_[n] = {from[0], from[1], along, across, kBlur * std::sqrt(along * along + across * across)};
        extent_ = std::max({extent_, std::abs(from[0]), std::abs(from[1])});
    }
}

// Looks at eight triangles, and keeps those of which a part lies within the limit. False if one forbids a conclusion.
bool Column::add_parts(const Patch& patch, std::size_t first) {
    Vector<Floats> u, v, h;
    for (std::size_t n = 0; n < 3; ++n) {
        const auto at = patch.in_lanes(n, first);
        u[n] = at[0];
        v[n] = at[1];
        h[n] = at[2];
    }
    auto outside = Floats(0.0f) < Floats(0.0f);
    for (const Wall& wall : walls_) {
        const Floats deepest =
            greatest(wall.depth(u[0], v[0]), greatest(wall.depth(u[1], v[1]), wall.depth(u[2], v[2])));
        outside = outside | (deepest < Floats(-wall.blur));
    }
    const Floats lowest = least(h[0], least(h[1], h[2])), highest = greatest(h[0], greatest(h[1], h[2]));
    const Floats beyond(limit_ + kBlur), limit(limit_), zero(0.0f);
    const auto beside = outside | (beyond < lowest) | (highest < zero - beyond);
    const unsigned valid = patch.size() - first < kLanes ? (1u << (patch.size() - first)) - 1 : 255u;
    const unsigned over = ~beside.bits() & valid;
    const unsigned whole = over & ((zero - limit <= lowest) & (highest <= limit)).bits();
    unsigned within = whole;
    unsigned partly = over & ~whole;
    if (partly != 0) partly &= ~apart(u, v);
    if (partly != 0) {
        const unsigned flat = partly & has_low_plane(u, v, h);
        if (flat != 0) distance_ = limit_;
        within |= flat;
        partly &= ~flat;
    }
    for (unsigned bits = partly; bits != 0; bits &= bits - 1) {
        const auto lane = static_cast<std::size_t>(std::countr_zero(bits));
        std::array<Height, 3> triangle;
        for (std::size_t n = 0; n < 3; ++n) triangle[n] = {u[n].each()[lane], v[n].each()[lane], h[n].each()[lane]};
        const Part part = part_of(triangle);
        if (part == Part::across) return false;
        if (part == Part::within) {
            within |= 1u << lane;
            distance_ = limit_;
        }
    }
    if (within & patch.at_border(first)) return false;
    if (whole != 0) {
        std::array<float, kLanes> packed{};
        std::array<float, kLanes> heights{};
        greatest(highest, zero - lowest).pack(whole, packed.data());
        std::copy_n(packed.begin(), std::popcount(whole), heights.begin());
        distance_ = std::max(distance_, *std::max_element(heights.begin(), heights.end()));
    }
    for (std::size_t n = 0; n < 3; ++n) {
        u[n].pack(within, places_[2 * n].data() + count_);
        v[n].pack(within, places_[2 * n + 1].data() + count_);
    }
    count_ += static_cast<std::size_t>(std::popcount(within));
    return true;
}

// Which of eight triangles have a side that the column's triangle lies beyond.
unsigned Column::apart(const Vector<Floats>& u, const Vector<Floats>& v) const {
    const Floats zero(0.0f), blur(kBlur);
    auto out = zero < zero;
    for (std::size_t n = 0; n < 3; ++n) {
        const std::size_t m = n == 2 ? 0 : n + 1, other = 3 - n - m;
        const Floats along = u[m] - u[n], across = v[m] - v[n];
        const auto side = [&](const Floats& at_u, const Floats& at_v) {
            return along * (at_v - v[n]) - across * (at_u - u[n]);
        };
        const Floats own = side(u[other], v[other]);
        const Floats a = side(walls_[0].u, walls_[0].v), b = side(walls_[1].u, walls_[1].v),
                     c = side(walls_[2].u, walls_[2].v);
        const Floats longer = greatest(along, zero - along) + greatest(across, zero - across);
        const Floats margin = blur * longer * Floats(1 + extent_);
        out = out | ((zero < own) & (greatest(a, greatest(b, c)) < zero - margin)) |
              ((own < zero) & (margin < least(a, least(b, c))));
    }
    return out.bits();
}

// Of which of eight triangles does the plane lie within the limit over all of the column's triangle? Then so does what
// of them lies in the column. Not of those that are nearly upright, whose planes rounding tilts.
unsigned Column::has_low_plane(const Vector<Floats>& u, const Vector<Floats>& v, const Vector<Floats>& h) const {
    const Floats zero(0.0f), u1 = u[1] - u[0], v1 = v[1] - v[0], h1 = h[1] - h[0], u2 = u[2] - u[0], v2 = v[2] - v[0],
                             h2 = h[2] - h[0], area = u1 * v2 - u2 * v1;
    const Floats along = (h1 * v2 - h2 * v1) / area, across = (u1 * h2 - u2 * h1) / area;
    const auto height = [&](const Wall& corner) {
        return h[0] + along * (Floats(corner.u) - u[0]) + across * (Floats(corner.v) - v[0]);
    };
    const Floats a = height(walls_[0]), b = height(walls_[1]), c = height(walls_[2]);
    const Floats limit(limit_ - kTilt * (1 + extent_));
    constexpr float kUpright = 0.01f;
    return ((greatest(a, greatest(b, c)) <= limit) & (zero - limit <= least(a, least(b, c))) &
            ((Floats(kUpright) < area) | (area < Floats(-kUpright))))
        .bits();
}

// What of a triangle lies in the column: clipped at the column's three walls, a blur outside.
Column::Part Column::part_of(const std::array<Height, 3>& triangle) const {
    std::array<Height, 6> part, next;
    std::size_t count = 3;
    std::copy(triangle.begin(), triangle.end(), part.begin());
    for (const Wall& wall : walls_) {
        std::array<float, 6> beyond;
        std::size_t inside = 0;
        for (std::size_t n = 0; n < count; ++n) {
            beyond[n] = -wall.depth(part[n].u, part[n].v) - wall.blur;
            inside += static_cast<std::size_t>(beyond[n] <= 0);
        }
        if (inside == count) continue;
        if (inside == 0) return Part::none;
        std::size_t kept = 0;
        for (std::size_t n = 0; n < count; ++n) {
            const std::size_t m = n + 1 == count ? 0 : n + 1;
            const Height &from = part[n], &to = part[m];
            if (beyond[n] <= 0) next[kept++] = from;
            if ((beyond[n] <= 0) != (beyond[m] <= 0)) {
                const float share = beyond[n] / (beyond[n] - beyond[m]);
                next[kept++] = {from.u + share * (to.u - from.u), from.v + share * (to.v - from.v),
                                from.h + share * (to.h - from.h)};
            }
        }
        part = next;
        count = kept;
    }
    const auto [low, high] = std::minmax_element(part.begin(), part.begin() + count,
                                                 [](const Height& a, const Height& b) { return a.h < b.h; });
    if (low->h > limit_ + kBlur || high->h < -limit_ - kBlur) return Part::beyond;
    return low->h >= -limit_ && high->h <= limit_ ? Part::within : Part::across;
}

// Is a point of the triangle covered an odd number of times? No as well if that is hard to tell.
bool Column::is_odd_at(float share, float other_share) const {
    const Floats at_u(walls_[0].u + share * walls_[0].along - other_share * walls_[2].along),
        at_v(walls_[0].v + share * walls_[0].across - other_share * walls_[2].across);
    const Floats zero(0.0f), one(1.0f), blur(kBlur);
    const auto size = [&](const Floats& a) { return greatest(a, zero - a); };
    int covered = 0;
    for (std::size_t first = 0; first < count_; first += kLanes) {
        const auto place = [&](std::size_t n) { return Floats(places_[n].data() + first); };
        auto left = zero < zero, right = left, close = left;
        for (std::size_t n = 0; n < 3; ++n) {
            const std::size_t m = n == 2 ? 0 : n + 1;
            const Floats u = place(2 * n), v = place(2 * n + 1);
            const Floats along = place(2 * m) - u, across = place(2 * m + 1) - v;
            const Floats side = along * (at_v - v) - across * (at_u - u);
            const Floats margin = blur * (one + size(along) + size(across));
            left = left | (margin < side);
            right = right | (side < zero - margin);
            close = close | (size(side) <= margin);
        }
        const unsigned valid = count_ - first < kLanes ? (1u << (count_ - first)) - 1 : 255u;
        const unsigned over = ~(left & right).bits() & valid;
        if (over & close.bits()) return false;
        covered += std::popcount(over);
    }
    return covered % 2 == 1;
}

}  // namespace isocore::simplification
