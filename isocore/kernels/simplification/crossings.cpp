#include "simplification/crossings.hpp"

#include <algorithm>
#include <bit>
#include <limits>

#include "common/prefetch.hpp"

namespace isocore::simplification {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
Floats size_of(const Floats& a) { return greatest(a, Floats(0.0f) - a); }
Floats size_of(const Vector<Floats>& a) { return size_of(a[0]) + size_of(a[1]) + size_of(a[2]); }

}  // namespace

template <class Real>
bool Crossings<Real>::are_there(const Star& star, const Facets& facets, const std::vector<const Star*>& others) {
    prepare(star, facets);
    take_faces(star);
    if (meet_faces(star, true)) return true;
    for (const Star* other : others) {
        take_faces(*other);
        if (meet_faces(star, false)) return true;
    }
    find_cubes(star);
    find_triangles(star);
    take_triangles(star);
    return meet_faces(star, false);
}

template <class Real>
void Crossings<Real>::prepare(const Star& star, const Facets& facets) {
    reach_ = star.reach();
    lowest_.fill(kInfinity);
    highest_.fill(-kInfinity);
    target_ = star.place(0);
    for (std::size_t n = 1; n + 1 < star.count; n += kLanes) {
        for (std::size_t a = 0; a < 3; ++a) {
            const Floats to(target_[a]), one(star.places[a].data() + n), other(star.places[a].data() + n + 1);
            const Floats low = least(to, least(one, other)) - Floats(2 * rounding_);
            const Floats high = greatest(to, greatest(one, other)) + Floats(2 * rounding_);
            low.store(low_[a].data() + n);
            high.store(high_[a].data() + n);
            lowest_[a] = std::min(lowest_[a], low.least_lane());  // lanes past the end are as the target
            highest_[a] = std::max(highest_[a], high.greatest_lane());
        }
    }
    for (std::size_t n = 1; n + 1 < star.count; ++n) {
        const Spot normal = facets.frame(n - 1).h;
        for (std::size_t a = 0; a < 3; ++a) normal_[a][n] = normal[a];
        find_blur(star, n);
    }
}

// one, other: how long the two sides are, at least.
template <class Real>
template <class Number>
auto Crossings<Real>::blur_of(const Number& one, const Number& other) const -> Blur<Number> {
    const Number moved(4 * rounding_);  // no less than what the ends of a side, or of the way, move together
    const Number sides = one + other + moved;
    return {moved * (one * other + sides * moved), moved * sides};
}

template <class Real>
void Crossings<Real>::find_blur(const Star& star, std::size_t face) {
    near_blur_[face] = 0;
    far_blur_[face] = 1e-5f;
    if (rounding_ == 0) return;
    const Spot one = minus(star.place(face), target_), other = minus(star.place(face + 1), target_);
    const Blur<float> blur = blur_of(sum_of_sizes(one), sum_of_sizes(other));
    const float area = std::abs(dot({normal_[0][face], normal_[1][face], normal_[2][face]}, cross(one, other)));
    near_blur_[face] = blur.near / area;
    far_blur_[face] += 2 * blur.far / area;  // a way has two ends within reach
}

template <class Real>
void Crossings<Real>::find_cubes(const Star& star) {
    cubes_.clear();
    starts_[0] = 0;
    const auto place = [&](std::size_t n) { return &mesh_.places[static_cast<std::size_t>(star.neighbours[n])].at; };
    for (std::size_t n = 1; n + 1 < star.count; ++n) {
        grid_.cubes().touched<Real>({place(0), place(n), place(n + 1)}, cubes_);
        starts_[n] = cubes_.size();
    }
}

// Each triangle in these cubes once, but for the star's own.
template <class Real>
void Crossings<Real>::find_triangles(const Star& star) {
    for (std::size_t n = 0; n < star.count; ++n) {
        if (star.triangles[n] != kNone) seen_triangles_.add(star.triangles[n]);
    }
    std::size_t count = 0;
    for (const std::int32_t cube : cubes_) grid_.fetch(cube);
    for (const std::int32_t cube : cubes_) {
        if (!seen_cubes_.add(cube)) continue;
        grid_.each_in(cube, [&](const std::array<std::int32_t, TriangleGrid::kAtOnce>& some) {
            if (count + some.size() > triangles_.size()) triangles_.resize(2 * count + some.size());
            for (const std::int32_t triangle : some) {  // without branches, which would often be mispredicted
                triangles_[count] = triangle;
                count += static_cast<std::size_t>(seen_triangles_.add(triangle));
            }
        });
    }
    const std::span<const std::int32_t> found = std::span(triangles_).first(triangle_count_ = count);
    for (const std::int32_t triangle : found) ISOCORE_PREFETCH(mesh_.triangles.data() + triangle);
    for (const std::int32_t cube : cubes_) seen_cubes_.remove(cube);
    for (const std::int32_t triangle : found) seen_triangles_.remove(triangle);
    for (std::size_t n = 0; n < star.count; ++n) {
        if (star.triangles[n] != kNone) seen_triangles_.remove(star.triangles[n]);
    }
    for (const std::int32_t triangle : found) {
        for (const std::int32_t corner : mesh_.triangles[static_cast<std::size_t>(triangle)].corners)
            ISOCORE_PREFETCH(mesh_.places.data() + corner);
    }
}

// The faces are candidates for each other.
template <class Real>
void Crossings<Real>::take_faces(const Star& star) {
    const std::size_t count = star.face_count();
    candidates_.make_room(count);
    for (std::size_t n = 0; n < count; ++n) {
        const std::array<std::size_t, 3> ring{0, n + 1, n + 2};
        for (std::size_t c = 0; c < 3; ++c) {
            for (std::size_t a = 0; a < 3; ++a) candidates_.columns[3 * c + a][n] = star.places[a][ring[c]];
            candidates_.columns[Candidates::kNumbers + c][n] = std::bit_cast<float>(star.neighbours[ring[c]]);
        }
    }
    candidates_.count = count;
    candidates_.end();
}

// Those triangles that are not clearly apart from all faces.
template <class Real>
void Crossings<Real>::take_triangles(const Star& star) {
    const auto& origin = mesh_.places[static_cast<std::size_t>(star.centre)].at;
    const bool has_others = star.vanishing() == 1;  // whose triangles are the star's own
    near_.make_room(triangle_count_);
    std::size_t count = 0;
    for (const std::int32_t triangle : std::span(triangles_).first(triangle_count_)) {
        const auto& corners = mesh_.triangles[static_cast<std::size_t>(triangle)].corners;
        if (has_others && std::find(corners.begin(), corners.end(), star.centre) != corners.end()) continue;
        for (std::size_t c = 0; c < 3; ++c) {
            const auto& at = mesh_.places[static_cast<std::size_t>(corners[c])].at;
            for (std::size_t a = 0; a < 3; ++a) near_.columns[3 * c + a][count] = static_cast<float>(at[a] - origin[a]);
            near_.columns[Candidates::kNumbers + c][count] = std::bit_cast<float>(corners[c]);
        }
        ++count;
    }
    near_.count = count;
    near_.end();
    candidates_.make_room(near_.count);
    candidates_.count = 0;
    for (std::size_t first = 0; first < near_.count; first += kLanes) {
        std::array<Floats, Candidates::kColumns> columns;
        for (std::size_t n = 0; n < columns.size(); ++n) columns[n] = near_.in_lanes(n, first);
        auto apart = Floats(0.0f) < Floats(0.0f);
        for (std::size_t a = 0; a < 3; ++a) {
            for (std::size_t c = 0; c < 3; ++c) columns[3 * c + a] = columns[3 * c + a] * Floats(mesh_.stretch()[a]);
            apart = apart | (greatest(columns[a], greatest(columns[3 + a], columns[6 + a])) < Floats(lowest_[a])) |
                    (Floats(highest_[a]) < least(columns[a], least(columns[3 + a], columns[6 + a])));
        }
        const unsigned valid = near_.count - first < kLanes ? (1u << (near_.count - first)) - 1 : 255u;
        const unsigned bits = ~apart.bits() & valid;
        if (bits == 0) continue;
        for (std::size_t n = 0; n < columns.size(); ++n)
            columns[n].pack(bits, candidates_.columns[n].data() + candidates_.count);
        candidates_.count += static_cast<std::size_t>(std::popcount(bits));
    }
    candidates_.end();
}

template <class Real>
void Crossings<Real>::look_at(const Star& star, std::size_t first) {
    Eight& e = eight_;
    const Floats infinity(kInfinity);
    for (std::size_t c = 0; c < 3; ++c) {
        for (std::size_t a = 0; a < 3; ++a) e.at[c][a] = candidates_.in_lanes(3 * c + a, first);
        const Floats number = candidates_.in_lanes(Candidates::kNumbers + c, first);
        e.in_ring[c] = Floats(-1.0f);
        for (std::size_t m = 0; m < star.count; ++m)
            e.in_ring[c] = choose(have_same_bits(number, Floats(std::bit_cast<float>(star.neighbours[m]))),
                                  Floats(static_cast<float>(m)), e.in_ring[c]);
    }
    for (std::size_t a = 0; a < 3; ++a) {
        e.low[a] = least(e.at[0][a], least(e.at[1][a], e.at[2][a]));
        e.high[a] = greatest(e.at[0][a], greatest(e.at[1][a], e.at[2][a]));
    }
    const auto one = minus(e.at[1], e.at[0]), other = minus(e.at[2], e.at[0]), normal = cross(one, other);
    e.reach = greatest(Floats(reach_), greatest(size_of(e.at[0]), greatest(size_of(e.at[1]), size_of(e.at[2]))));
    const Blur<Floats> blur = blur_of(size_of(one), size_of(other));
    e.blur = (Floats(1e-6f) * size_of(one) * size_of(other) + Floats(2) * blur.far) * e.reach + blur.near;
    for (std::size_t m = 0; m < star.count; ++m) {
        const Spot place = star.place(m);
        const Floats off = dot(minus({place[0], place[1], place[2]}, e.at[0]), normal);
        const Floats number(static_cast<float>(m));
        const auto is_corner = (e.in_ring[0] == number) | (e.in_ring[1] == number) | (e.in_ring[2] == number);
        e.least[m] = choose(is_corner, infinity, off);
        e.most[m] = choose(is_corner, Floats(-kInfinity), off);
    }
}

// Which of the eight are apart from a face. Two triangles are if all their corners lie strictly on one side of the
// other's plane; corners that they have in common may lie in it.
template <class Real>
unsigned Crossings<Real>::apart(std::size_t face) const {
    const Eight& e = eight_;
    const Floats zero(0.0f), face_blur = Floats(near_blur_[face]) + Floats(far_blur_[face]) * e.reach,
                             own(static_cast<float>(face)), next(static_cast<float>(face + 1));
    const Floats lowest = least(e.least[0], least(e.least[face], e.least[face + 1]));
    const Floats highest = greatest(e.most[0], greatest(e.most[face], e.most[face + 1]));
    auto apart = (e.blur < lowest) | (highest < zero - e.blur);
    const Vector<Floats> target{target_[0], target_[1], target_[2]},
        normal{normal_[0][face], normal_[1][face], normal_[2][face]};
    Floats below(kInfinity), above(-kInfinity);
    for (std::size_t c = 0; c < 3; ++c) {
        const Floats off = dot(minus(e.at[c], target), normal);
        const auto shared = (e.in_ring[c] == own) | (e.in_ring[c] == next) | (e.in_ring[c] == zero);
        below = least(below, choose(shared, Floats(kInfinity), off));
        above = greatest(above, choose(shared, Floats(-kInfinity), off));
    }
    apart = apart | (face_blur < below) | (above < zero - face_blur);
    for (std::size_t a = 0; a < 3; ++a)
        apart = apart | (Floats(high_[a][face]) < e.low[a]) | (e.high[a] < Floats(low_[a][face]));
    return apart.bits();
}

// are_faces: candidate n is face n + 1, and is looked at with the faces before it only.
template <class Real>
bool Crossings<Real>::meet_faces(const Star& star, bool are_faces) {
    for (std::size_t first = 0; first < candidates_.count; first += kLanes) {
        look_at(star, first);
        for (std::size_t face = 1; face + 1 < star.count; ++face) {
            unsigned bits = ~apart(face) & 255u;
            for (; bits != 0; bits &= bits - 1) {
                const std::size_t n = first + static_cast<std::size_t>(std::countr_zero(bits));
                if (n >= candidates_.count) break;
                if (are_faces && n < face) continue;
                if (meet(exact({star.target(), star.neighbours[face], star.neighbours[face + 1]}),
                         exact(candidates_.numbers(n))))
                    return true;
            }
        }
    }
    return false;
}

template <class Real>
void Crossings<Real>::Candidates::make_room(std::size_t room) {
    if (columns[0].size() >= room + 2 * kLanes) return;
    for (auto& column : columns) column.resize(2 * room + 2 * kLanes);
}

template <class Real>
void Crossings<Real>::Candidates::end() {
    for (auto& column : columns) Floats(0.0f).store(column.data() + count);
}

template <class Real>
std::array<std::int32_t, 3> Crossings<Real>::Candidates::numbers(std::size_t triangle) const {
    const auto number = [&](std::size_t c) { return std::bit_cast<std::int32_t>(columns[kNumbers + c][triangle]); };
    return {number(0), number(1), number(2)};
}

template <class Real>
Corners3 Crossings<Real>::exact(const std::array<std::int32_t, 3>& numbers) const {
    Corners3 out{numbers, {}};
    for (std::size_t n = 0; n < 3; ++n)
        out.places[n] = mesh_.writing().written(mesh_.places[static_cast<std::size_t>(numbers[n])].at);
    return out;
}

template class Crossings<float>;
template class Crossings<double>;

}  // namespace isocore::simplification
