#include "simplification/crossings.hpp"

#include <algorithm>
#include <bit>
#include <limits>

namespace isocore::simplification {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr std::array<float, Ring::kRoom> kNumbers = [] {
    std::array<float, Ring::kRoom> out{};
    for (std::size_t n = 0; n < out.size(); ++n) out[n] = static_cast<float>(n);
    return out;
}();

// Asks for memory that is looked at soon.
template <class T>
void prefetch([[maybe_unused]] const T* place) {
#if defined(__GNUC__)
    __builtin_prefetch(place);
#endif
}

float size_of(const Spot& a) { return std::abs(a[0]) + std::abs(a[1]) + std::abs(a[2]); }

}  // namespace

template <class Real>
bool Crossings<Real>::are_there(const Star& star, const Facets& facets, const std::vector<const Star*>& others) {
    prepare(star, facets);
    for (std::size_t n = 1; n + 2 < star.count; ++n) {
        const Candidate face{{star.target(), star.neighbours[n], star.neighbours[n + 1]},
                             {0, static_cast<int>(n), static_cast<int>(n + 1)},
                             {star.place(0), star.place(n), star.place(n + 1)}};
        if (meets_a_face(star, face, n + 1)) return true;
    }
    for (const Star* other : others) {
        if (meets_faces_of(star, *other)) return true;
    }
    find_cubes(star);
    find_candidates(star);
    const bool has_others = star.vanishing() == 1;
    return std::any_of(candidates_.begin(), candidates_.end(), [&](std::int32_t triangle) {
        const auto& corners = mesh_.triangles[static_cast<std::size_t>(triangle)].corners;
        if (has_others && std::find(corners.begin(), corners.end(), star.centre) != corners.end()) return false;
        const auto found = candidate(star, corners);
        return found && meets_a_face(star, *found, 1);
    });
}

template <class Real>
bool Crossings<Real>::meets_faces_of(const Star& star, const Star& other) const {
    for (std::size_t n = 1; n + 1 < other.count; ++n) {
        const auto found = candidate(star, {other.target(), other.neighbours[n], other.neighbours[n + 1]});
        if (found && meets_a_face(star, *found, 1)) return true;
    }
    return false;
}

template <class Real>
void Crossings<Real>::prepare(const Star& star, const Facets& facets) {
    reach_ = star.reach();
    lowest_.fill(kInfinity);
    highest_.fill(-kInfinity);
    const Spot target = star.place(0);
    for (std::size_t n = 1; n + 1 < star.count; n += kLanes) {
        for (std::size_t a = 0; a < 3; ++a) {
            const Floats to(target[a]), one(star.places[a].data() + n), other(star.places[a].data() + n + 1);
            const Floats low = least(to, least(one, other)), high = greatest(to, greatest(one, other));
            low.store(low_[a].data() + n);
            high.store(high_[a].data() + n);
            lowest_[a] = std::min(lowest_[a], low.least_lane());  // lanes past the end are as the target
            highest_[a] = std::max(highest_[a], high.greatest_lane());
        }
    }
    for (std::size_t n = 1; n + 1 < star.count; ++n) {
        const Spot normal = facets.frame(n - 1).h;
        for (std::size_t a = 0; a < 3; ++a) normal_[a][n] = normal[a];
    }
}

template <class Real>
void Crossings<Real>::find_cubes(const Star& star) {
    cubes_.clear();
    starts_[0] = 0;
    const auto place = [&](std::size_t n) { return &mesh_.places[static_cast<std::size_t>(star.neighbours[n])].at; };
    for (std::size_t n = 1; n + 1 < star.count; ++n) {
        grid_.cubes_of<Real>({place(0), place(n), place(n + 1)}, cubes_);
        starts_[n] = cubes_.size();
    }
}

// Each triangle in these cubes once, but for the star's own.
template <class Real>
void Crossings<Real>::find_candidates(const Star& star) {
    for (std::size_t n = 0; n < star.count; ++n) {
        if (star.triangles[n] != kNone) seen_triangles_.add(star.triangles[n]);
    }
    candidates_.clear();
    for (const std::int32_t cube : cubes_) {
        if (!seen_cubes_.add(cube)) continue;
        grid_.each_in(cube, [&](std::int32_t triangle) {
            if (!seen_triangles_.add(triangle)) return;
            candidates_.push_back(triangle);
            prefetch(mesh_.triangles.data() + triangle);
        });
    }
    for (const std::int32_t cube : cubes_) seen_cubes_.forget_near(cube);
    for (const std::int32_t triangle : candidates_) seen_triangles_.forget_near(triangle);
    for (std::size_t n = 0; n < star.count; ++n) {
        if (star.triangles[n] != kNone) seen_triangles_.forget_near(star.triangles[n]);
    }
    for (const std::int32_t triangle : candidates_) {
        for (const std::int32_t corner : mesh_.triangles[static_cast<std::size_t>(triangle)].corners)
            prefetch(mesh_.places.data() + corner);
    }
}

// Nothing if the triangle is clearly apart from all faces.
template <class Real>
auto Crossings<Real>::candidate(const Star& star, const std::array<std::int32_t, 3>& corners) const
    -> std::optional<Candidate> {
    const auto& origin = mesh_.places[static_cast<std::size_t>(star.centre)].at;
    Candidate out{corners, {-1, -1, -1}, {}};
    for (std::size_t n = 0; n < 3; ++n)
        out.at[n] = mesh_.relative(mesh_.places[static_cast<std::size_t>(out.numbers[n])].at, origin);
    for (std::size_t a = 0; a < 3; ++a) {
        if (std::max({out.at[0][a], out.at[1][a], out.at[2][a]}) < lowest_[a]) return {};
        if (highest_[a] < std::min({out.at[0][a], out.at[1][a], out.at[2][a]})) return {};
    }
    for (std::size_t n = 0; n < 3; ++n) {
        for (std::size_t m = 0; m < star.count; ++m) {
            if (star.neighbours[m] == out.numbers[n]) out.in_ring[n] = static_cast<int>(m);
        }
    }
    return out;
}

// Two triangles are apart if all their corners lie strictly on one side of the other's plane; corners that they have in
// common may lie in it.
template <class Real>
bool Crossings<Real>::meets_a_face(const Star& star, const Candidate& candidate, std::size_t first_face) const {
    const auto& at = candidate.at;
    Spot low, high;
    for (std::size_t a = 0; a < 3; ++a) {
        low[a] = std::min({at[0][a], at[1][a], at[2][a]});
        high[a] = std::max({at[0][a], at[1][a], at[2][a]});
    }
    const Spot one = minus(at[1], at[0]), other = minus(at[2], at[0]), normal = cross(one, other);
    const float reach = std::max({reach_, size_of(at[0]), size_of(at[1]), size_of(at[2])});
    const Floats blur(1e-6f * size_of(one) * size_of(other) * reach), face_blur(1e-5f * reach), zero(0.0f);
    PerFace least_of, most_of;  // how far each neighbour lies from the candidate's plane
    for (std::size_t n = 0; n <= star.count; n += kLanes) {
        const auto to = minus(star.in_lanes(n), {at[0][0], at[0][1], at[0][2]});
        const Floats off = dot(to, {normal[0], normal[1], normal[2]});
        off.store(least_of.data() + n);
        off.store(most_of.data() + n);
    }
    for (const int n : candidate.in_ring) {
        if (n < 0) continue;
        least_of[static_cast<std::size_t>(n)] = kInfinity;
        most_of[static_cast<std::size_t>(n)] = -kInfinity;
    }
    const Spot target = star.place(0);
    for (std::size_t n = first_face; n + 1 < star.count; n += kLanes) {
        const Floats lowest = least(least_of[0], least(Floats(least_of.data() + n), Floats(least_of.data() + n + 1)));
        const Floats highest =
            greatest(most_of[0], greatest(Floats(most_of.data() + n), Floats(most_of.data() + n + 1)));
        auto apart = (blur < lowest) | (highest < zero - blur);
        Floats below(kInfinity), above(-kInfinity);
        const Floats number(kNumbers.data() + n), next(kNumbers.data() + n + 1);
        for (std::size_t c = 0; c < 3; ++c) {
            const Spot to = minus(at[c], target);
            Floats off(0.0f);
            for (std::size_t a = 0; a < 3; ++a) off = off + Floats(normal_[a].data() + n) * Floats(to[a]);
            const Floats mine(static_cast<float>(candidate.in_ring[c]));
            const auto shared = (number == mine) | (next == mine) | (mine == zero);
            below = least(below, choose(shared, Floats(kInfinity), off));
            above = greatest(above, choose(shared, Floats(-kInfinity), off));
        }
        apart = apart | (face_blur < below) | (above < zero - face_blur);
        for (std::size_t a = 0; a < 3; ++a)
            apart =
                apart | (Floats(high_[a].data() + n) < Floats(low[a])) | (Floats(high[a]) < Floats(low_[a].data() + n));
        const std::size_t faces = std::min(kLanes, star.count - 1 - n);
        for (unsigned bits = ~apart.bits() & ((1u << faces) - 1); bits != 0; bits &= bits - 1) {
            const std::size_t face = n + static_cast<std::size_t>(std::countr_zero(bits));
            if (meet(exact({star.target(), star.neighbours[face], star.neighbours[face + 1]}),
                     exact(candidate.numbers)))
                return true;
        }
    }
    return false;
}

template <class Real>
Corners3 Crossings<Real>::exact(const std::array<std::int32_t, 3>& numbers) const {
    Corners3 out{numbers, {}};
    for (std::size_t n = 0; n < 3; ++n) {
        const auto& at = mesh_.places[static_cast<std::size_t>(numbers[n])].at;
        out.places[n] = {static_cast<double>(at[0]), static_cast<double>(at[1]), static_cast<double>(at[2])};
    }
    return out;
}

template class Crossings<float>;
template class Crossings<double>;

}  // namespace isocore::simplification
