#include "simplification/column.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace isocore::simplification {
namespace {

// Distances below this, in cells, are not told apart: some times what rounding does to places a few cells away.
constexpr float kBlur = 1e-5f;
constexpr float kFar = 1e9f;       // what lanes past the end hold
constexpr float kUpright = 0.01f;  // square cells: seen from above, a triangle of less has no plane to speak of

Floats size_of(const Floats& a) { return greatest(a, Floats(0.0f) - a); }

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
    Range range{least(h[0], least(h[1], h[2])), greatest(h[0], greatest(h[1], h[2]))};
    const Floats beyond(limit_ + kBlur), limit(limit_), zero(0.0f);
    const auto are_beyond = [&] { return (beyond < range.lowest) | (range.highest < zero - beyond); };
    const auto are_within = [&] { return (zero - limit <= range.lowest) & (range.highest <= limit); };
    const unsigned valid = patch.size() - first < kLanes ? (1u << (patch.size() - first)) - 1 : 255u;
    const unsigned over = ~(outside | are_beyond()).bits() & valid;
    if (over == 0) return true;
    if (over & ~are_within().bits()) range = parts(u, v, h);
    const unsigned within = over & are_within().bits();
    if (over & ~within & ~are_beyond().bits()) return false;
    if (within & patch.at_border(first)) return false;
    if (within == 0) return true;
    std::array<float, 2 * kLanes> heights{};
    greatest(range.highest, zero - range.lowest).pack(within, heights.data());
    const auto count = static_cast<std::size_t>(std::popcount(within));
    distance_ = std::max(distance_, *std::max_element(heights.begin(), heights.begin() + count));
    for (std::size_t n = 0; n < 3; ++n) {
        u[n].pack(within, places_[2 * n].data() + count_);
        v[n].pack(within, places_[2 * n + 1].data() + count_);
    }
    count_ += count;
    return true;
}

// A part's lowest and highest places are ends of what of its triangle's sides lies in the column, or lie straight above
// or below a corner of the column's triangle.
Column::Range Column::parts(const Vector<Floats>& u, const Vector<Floats>& v, const Vector<Floats>& h) const {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    Range out{Floats(kInfinity), Floats(-kInfinity)};
    add_sides(u, v, h, out);
    add_corners(u, v, h, out);
    return out;
}

// Where each side enters the column, a blur outside, and where it leaves it.
void Column::add_sides(const Vector<Floats>& u, const Vector<Floats>& v, const Vector<Floats>& h, Range& out) const {
    const Floats zero(0.0f), one(1.0f), never(2.0f);
    std::array<Vector<Floats>, 3> depths;  // by wall
    for (std::size_t w = 0; w < 3; ++w) {
        for (std::size_t n = 0; n < 3; ++n) depths[w][n] = walls_[w].depth(u[n], v[n]) + Floats(walls_[w].blur);
    }
    for (std::size_t n = 0; n < 3; ++n) {
        const std::size_t m = n == 2 ? 0 : n + 1;
        Floats enters = zero, leaves = one;  // shares of the side
        for (const Vector<Floats>& depth : depths) {
            const auto starts_outside = depth[n] < zero, ends_outside = depth[m] < zero;
            const Floats share = depth[n] / (depth[n] - depth[m]);
            enters = choose(starts_outside, greatest(enters, choose(ends_outside, never, share)), enters);
            leaves = choose(ends_outside, least(leaves, choose(starts_outside, leaves, share)), leaves);
        }
        const Floats way = h[m] - h[n], from = h[n] + enters * way, to = h[n] + leaves * way;
        out.add(enters <= leaves, {least(from, to), greatest(from, to)});
    }
}

// How high eight triangles pass over the corners of the column's triangle, where they do. One that is nearly upright
// may pass there at any of its heights.
void Column::add_corners(const Vector<Floats>& u, const Vector<Floats>& v, const Vector<Floats>& h, Range& out) const {
    const Floats zero(0.0f), blur(kBlur);
    const Range whole{least(h[0], least(h[1], h[2])), greatest(h[0], greatest(h[1], h[2]))};
    const Floats u1 = u[1] - u[0], v1 = v[1] - v[0], h1 = h[1] - h[0], u2 = u[2] - u[0], v2 = v[2] - v[0],
                 h2 = h[2] - h[0], area = u1 * v2 - u2 * v1;  // doubled
    const Floats along = (h1 * v2 - h2 * v1) / area, across = (u1 * h2 - u2 * h1) / area;
    const Floats turn = choose(area < zero, Floats(-1.0f), Floats(1.0f));
    const Floats slack = blur * (size_of(along) + size_of(across));
    const auto is_upright = size_of(area) < Floats(kUpright);
    for (const Wall& corner : walls_) {
        const Floats at_u(corner.u), at_v(corner.v);
        auto is_over = zero <= zero;
        for (std::size_t n = 0; n < 3; ++n) {
            const std::size_t m = n == 2 ? 0 : n + 1;
            const Floats to_u = u[m] - u[n], to_v = v[m] - v[n];
            const Floats margin = blur * (size_of(to_u) + size_of(to_v)) * Floats(1 + extent_);
            is_over = is_over & (zero - margin <= turn * (to_u * (at_v - v[n]) - to_v * (at_u - u[n])));
        }
        const Floats height = h[0] + along * (at_u - u[0]) + across * (at_v - v[0]);
        out.add(is_over, {choose(is_upright, whole.lowest, greatest(whole.lowest, height - slack)),
                          choose(is_upright, whole.highest, least(whole.highest, height + slack))});
    }
}

// Is a point of the triangle covered an odd number of times? No as well if that is hard to tell.
bool Column::is_odd_at(float share, float other_share) const {
    const Floats at_u(walls_[0].u + share * walls_[0].along - other_share * walls_[2].along),
        at_v(walls_[0].v + share * walls_[0].across - other_share * walls_[2].across);
    const Floats zero(0.0f), one(1.0f), blur(kBlur);
    int covered = 0;
    for (std::size_t first = 0; first < count_; first += kLanes) {
        const auto place = [&](std::size_t n) { return Floats(places_[n].data() + first); };
        auto left = zero < zero, right = left, close = left;
        for (std::size_t n = 0; n < 3; ++n) {
            const std::size_t m = n == 2 ? 0 : n + 1;
            const Floats u = place(2 * n), v = place(2 * n + 1);
            const Floats along = place(2 * m) - u, across = place(2 * m + 1) - v;
            const Floats side = along * (at_v - v) - across * (at_u - u);
            const Floats margin = blur * (one + size_of(along) + size_of(across));
            left = left | (margin < side);
            right = right | (side < zero - margin);
            close = close | (size_of(side) <= margin);
        }
        const unsigned valid = count_ - first < kLanes ? (1u << (count_ - first)) - 1 : 255u;
        const unsigned over = ~(left & right).bits() & valid;
        if (over & close.bits()) return false;
        covered += std::popcount(over);
    }
    return covered % 2 == 1;
}

}  // namespace isocore::simplification
