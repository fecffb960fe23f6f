#include "simplification/backward.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace isocore::simplification {
namespace {

constexpr float kSmall = 6;            // cells: a longer triangle is quartered before it is taken to pieces
constexpr int kHalvings = 16;          // of a triangle and its pieces, one after the other
constexpr int kMostHalvings = 384;     // of all pieces of a triangle
constexpr float kLeastMargin = 0.01f;  // cells
constexpr float kBoxMargin = 1e-3f;    // cells: more than rounding does to a box
constexpr float kLeastHeight = 1e-3f;  // of its sides, that a triangle must have for a frame of its own

Spot between(const Spot& a, const Spot& b) {
    return {0.5f * (a[0] + b[0]), 0.5f * (a[1] + b[1]), 0.5f * (a[2] + b[2])};
}

// The squared lengths of a triangle's sides, from each corner to the next.
std::array<float, 3> squared_sides(const std::array<Spot, 3>& t) {
    std::array<float, 3> out;
    for (std::size_t n = 0; n < 3; ++n) {
        const Spot side = minus(t[n], t[n == 2 ? 0 : n + 1]);
        out[n] = dot(side, side);
    }
    return out;
}

float longest_side(const std::array<Spot, 3>& t) {
    const auto squared = squared_sides(t);
    return std::sqrt(*std::max_element(squared.begin(), squared.end()));
}

// The four similar triangles that a triangle's middles cut it into: those at its corners, then that in the middle.
std::array<std::array<Spot, 3>, 4> quarters(const std::array<Spot, 3>& c) {
    const Spot ab = between(c[0], c[1]), bc = between(c[1], c[2]), ca = between(c[2], c[0]);
    return {std::array{c[0], ab, ca}, std::array{ab, c[1], bc}, std::array{ca, bc, c[2]}, std::array{ab, bc, ca}};
}

}  // namespace

// Copies pay where they are read many times, and the limit is small beside a box.
template <class Real>
void Backward<Real>::enter_box(const Cell& low, const Cell& high, float limit) {
    leave_box();
    if (!reference_.index().is_in_order() || reference_.mesh().sheets != nullptr || limit > kFarthest) return;
    const Cells& cells = reference_.cells();
    Cell from, to;
    for (std::size_t a = 0; a < 3; ++a) {
        const float reach = (limit + kBoxMargin) / mesh_.stretch()[a] * static_cast<float>(cells.per_cell);
        if (!(reach < Rows::kMostCells)) return;  // very flat cells
        const auto margin = static_cast<std::int32_t>(reach) + 2;
        from[a] = std::max(low[a] - margin, 0);
        to[a] = std::min(high[a] + margin, static_cast<std::int32_t>(cells.dims[a]) - 1);
    }
    if (to[0] - from[0] < Rows::kMostCells) rows_.cover(from, to);
}

template <class Real>
bool Backward<Real>::are_near(const Star& star, const Facets& facets, float limit) {
    limit_ = limit;
    if (!is_provable(limit)) {
        distances_.assign(star.face_count(), std::numeric_limits<float>::infinity());
        return true;
    }
    const float margin = limit + kBoxMargin;
    const auto face = [&](std::size_t n) { return Corners{star.place(0), star.place(n), star.place(n + 1)}; };
    Box box = Box::around(face(1), margin);
    for (std::size_t n = 2; n + 1 < star.count; ++n) box.add(Box::around(face(n), margin));
    near_star_.gather(reference_, rows_, mesh_, mesh_.places[static_cast<std::size_t>(star.centre)].at, box,
                      star.sheet);
    // A star is refused for one face, so those come first that leave most of the vertex's height.
    order_.clear();
    for (std::size_t n = 1; n + 1 < star.count; ++n) {
        const float height = std::abs(dot(facets.frame(n - 1).h, star.place(0)));
        order_.push_back({height > 0 ? -height : 0.0f, n});  // that of a face without area is no number
    }
    std::sort(order_.begin(), order_.end());
    distances_.resize(star.face_count());
    for (const auto& [height, n] : order_) {
        if (!is_near(face(n), facets.frame(n - 1))) return false;
        distances_[n - 1] = distance_;
    }
    return true;
}

template <class Real>
float Backward<Real>::distance(std::int32_t triangle, float limit) {
    limit_ = limit;
    const auto& corners = mesh_.triangles[static_cast<std::size_t>(triangle)].corners;
    const auto place = [&](std::size_t n) { return mesh_.places[static_cast<std::size_t>(corners[n])].at; };
    const Corners face{Spot{0, 0, 0}, mesh_.relative(place(1), place(0)), mesh_.relative(place(2), place(0))};
    near_star_.gather(reference_, rows_, mesh_, place(0), Box::around(face, limit + kBoxMargin),
                      mesh_.sheet_of(triangle));
    frame_.clear();
    frame_.add(face[0], face[1], face[2]);
    frame_.find_frames();
    return is_near(face, frame_.frame(0)) ? distance_ : std::numeric_limits<float>::infinity();
}

// frame: the triangle's. That of a sliver is full of rounding, and is not used.
template <class Real>
bool Backward<Real>::is_near(const Corners& triangle, const Facets::Frame& frame) {
    distance_ = 0;
    const float margin = limit_ + kBoxMargin;
    const Box box = Box::around(triangle, margin);
    is_plumbed_ = frame.top_v > kLeastHeight * (frame.length + std::abs(frame.top_u));
    if (!is_plumbed_) {
        near_[0].select(near_star_, box);
        return is_near(triangle, 0);
    }
    near_[0].select(near_star_, box, frame, margin);
    return is_near({Spot{0, 0, 0}, Spot{frame.length, 0, 0}, Spot{frame.top_u, frame.top_v, 0}}, 0);
}

// near_[depth]: triangles of the reference, all that are near and perhaps others.
template <class Real>
bool Backward<Real>::is_near(const Corners& triangle, std::size_t depth) {
    Patch& near = near_[depth];
    if (near.size() == 0) return false;
    if (is_plumbed_ && column_.is_covered(triangle, near, limit_)) {
        distance_ = std::max(distance_, column_.distance());
        return true;
    }
    if (longest_side(triangle) <= kSmall || depth + 1 == near_.size()) {
        take_facets(triangle, near);
        distance_ = limit_;
        return facets_.size() > 0 && is_near_by_pieces(triangle);
    }
    const auto parts = quarters(triangle);
    return std::all_of(parts.begin(), parts.end(), [&](const Corners& part) {
        near_[depth + 1].select(near, Box::around(part, limit_ + kBoxMargin));
        return is_near(part, depth + 1);
    });
}

// Some of the triangles may be enough: the nearest, where there are too many.
template <class Real>
void Backward<Real>::take_facets(const Corners& triangle, Patch& near) {
    for (float margin = limit_; near.size() > kMostTriangles && margin > kLeastMargin; margin *= 0.7f)
        near.select(near, Box::around(triangle, margin));
    facets_.clear();
    if (near.size() > kMostTriangles) return;
    for (std::size_t n = 0; n < near.size(); n += kLanes)
        facets_.add({near.in_lanes(0, n), near.in_lanes(1, n), near.in_lanes(2, n)}, std::min(kLanes, near.size() - n));
    facets_.find_frames();
}

// Distance to a convex set is a convex function: a piece whose three corners lie within the limit of one triangle of
// the reference lies within the limit altogether.
template <class Real>
bool Backward<Real>::is_near_by_pieces(const Corners& t) {
    words_ = (facets_.size() + 63) / 64;
    halvings_ = kMostHalvings;
    std::array<Within, 3> within;
    for (std::size_t n = 0; n < 3; ++n) {
        if (!find_within(t[n], within[n])) return false;
    }
    return is_near_by_halves(t, {&within[0], &within[1], &within[2]}, kHalvings);
}

template <class Real>
bool Backward<Real>::is_near_by_halves(const Corners& t, const OfCorners& within, int depth) {
    for (std::size_t word = 0; word < words_; ++word) {
        if ((*within[0])[word] & (*within[1])[word] & (*within[2])[word]) return true;
    }
    if (depth == 0 || halvings_ == 0) return false;
    --halvings_;
    const auto squared = squared_sides(t);
    const auto a = static_cast<std::size_t>(std::max_element(squared.begin(), squared.end()) - squared.begin());
    const std::size_t b = a == 2 ? 0 : a + 1, c = b == 2 ? 0 : b + 1;
    const Spot middle = between(t[a], t[b]);
    Within of_middle;
    return find_within(middle, of_middle) &&
           is_near_by_halves({t[a], middle, t[c]}, {within[a], &of_middle, within[c]}, depth - 1) &&
           is_near_by_halves({middle, t[b], t[c]}, {&of_middle, within[b], within[c]}, depth - 1);
}

// Of which facets does a point lie within the limit? False if there are none.
template <class Real>
bool Backward<Real>::find_within(const Spot& point, Within& out) const {
    const Vector<Floats> at{point[0], point[1], point[2]};
    const Floats most(limit_ * limit_);
    std::uint64_t any = 0;
    for (std::size_t word = 0; word < words_; ++word) {
        const std::size_t begin = 64 * word, count = std::min<std::size_t>(facets_.size() - begin, 64);
        std::uint64_t bits = 0;
        for (std::size_t n = 0; n < count; n += kLanes)
            bits |= static_cast<std::uint64_t>((facets_.from_point(begin + n, at) <= most).bits()) << n;
        out[word] = bits & ~std::uint64_t{0} >> (64 - count);  // not of those past the end
        any |= out[word];
    }
    return any != 0;
}

template class Backward<float>;
template class Backward<double>;

}  // namespace isocore::simplification
