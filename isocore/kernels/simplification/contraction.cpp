#include "simplification/contraction.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "common/prefetch.hpp"

namespace isocore::simplification {
namespace {

// How far the origin is from the line between two places.
float distance_to_line(const Spot& from, const Spot& to) {
    const Spot way = minus(to, from);
    const float length = dot(way, way);
    const float share = length > 0 ? std::clamp(-dot(from, way) / length, 0.0f, 1.0f) : 0.0f;
    const Spot at{from[0] + share * way[0], from[1] + share * way[1], from[2] + share * way[2]};
    return std::sqrt(dot(at, at));
}

}  // namespace

template <class Real>
bool Contraction<Real>::contract(const Ring& ring, std::size_t target) {
    if (mesh_.vertices[static_cast<std::size_t>(ring.centre)].on_curve) {
        gather_fans(ring.centre, ring.neighbours[target]);
    } else {
        count_ = 1;
        parts_[0].star.turn(ring, target);
    }
    if (!are_allowed() || !are_apart()) return false;
    commit();
    return true;
}

// A vertex on a curve: one star for each sheet there.
template <class Real>
void Contraction<Real>::gather_fans(std::int32_t vertex, std::int32_t target) {
    std::array<std::size_t, Vertex::kMostTriangles> ends;
    count_ = mesh_.find_fans(mesh_.vertices[static_cast<std::size_t>(vertex)], ends);
    if (parts_.size() < count_) parts_.resize(count_);
    Ring fan;
    for (std::size_t n = 0, first = 0; n < count_; first = ends[n++]) {
        fan.gather_fan(mesh_, vertex, first, ends[n]);
        parts_[n].star.turn(fan, fan.neighbours[0] == target ? 0 : fan.count - 1);
    }
}

// Asks for what the first rule looks at.
template <class Real>
void Contraction<Real>::fetch_target() const {
    const Vertex& target = mesh_.vertices[static_cast<std::size_t>(parts_[0].star.target())];
    for (std::size_t n = 0; n < target.count; ++n) ISOCORE_PREFETCH(mesh_.triangles.data() + target.ring[n]);
}

// All rules but that of crossings, each for all stars.
template <class Real>
bool Contraction<Real>::are_allowed() {
    fetch_target();
    for (std::size_t n = 0; n < count_; ++n) {
        if (!parts_[n].star.has_good_shapes()) return refuse(Rule::shape, parts_[n].star);
    }
    for (std::size_t n = 0; n < count_; ++n) {
        if (!keeps_topology(parts_[n].star)) return refuse(Rule::link, parts_[n].star);
    }
    if (mesh_.vertices[static_cast<std::size_t>(parts_[0].star.centre)].on_curve && !keeps_curve(parts_[0].star))
        return refuse(Rule::outward, parts_[0].star);
    for (std::size_t n = 0; n < count_; ++n) {
        auto& [star, facets, witnesses, distances] = parts_[n];
        star.draw(facets);
        witnesses.gather(mesh_, star);
        if (!witnesses.are_near(facets, limit_here(star))) return refuse(Rule::outward, star);
    }
    for (std::size_t n = 0; n < count_; ++n) {
        auto& [star, facets, witnesses, distances] = parts_[n];
        if (!backward_.are_near(star, facets, limit_here(star))) return refuse(Rule::back, star);
        for (std::size_t face = 1; face + 1 < star.count; ++face) distances[face] = backward_.distance(face);
    }
    return true;
}

template <class Real>
bool Contraction<Real>::are_apart() {
    others_.clear();
    for (std::size_t n = count_; n-- > 0;) {
        if (crossings_.are_there(parts_[n].star, parts_[n].facets, others_))
            return refuse(Rule::crossing, parts_[n].star);
        others_.push_back(&parts_[n].star);
    }
    return true;
}

// The limit, less what rounding may have done to places that are so far apart.
template <class Real>
float Contraction<Real>::limit_here(const Star& star) const {
    return limit_ - 2e-6f * (1 + star.reach() + limit_);
}

// The link condition of T. K. Dey, H. Edelsbrunner, S. Guha, D. V. Nekhayev, "Topology preserving edge contraction",
// 1999: the two ends have no other neighbours in common than the two beside the edge, and are not two corners of a
// tetrahedron.
template <class Real>
bool Contraction<Real>::keeps_topology(const Star& star) const {
    const Vertex& target = mesh_.vertices[static_cast<std::size_t>(star.target())];
    if (target.on_curve || target.is_joint || count_ > 1) return keeps_topology_at_joint(star);
    if (target.odd || star.count < 3 || target.count + star.count > Vertex::kMostTriangles + 4) return false;
    std::array<std::int32_t, Vertex::kMostTriangles + 1> around;
    std::size_t count = 0;
    for (std::size_t n = 0; n < target.count; ++n) {
        const Triangle& triangle = mesh_.triangles[static_cast<std::size_t>(target.ring[n])];
        const std::size_t index = triangle.index_of(star.target());
        around[count++] = triangle.after(index);
        if (target.open && n + 1 == target.count) around[count++] = triangle.after(index == 2 ? 0 : index + 1);
    }
    std::size_t common = 0;
    for (std::size_t n = 1; n < star.count; ++n)
        common += static_cast<std::size_t>(std::count(around.begin(), around.begin() + count, star.neighbours[n]));
    return common == 2 && (star.count > 3 || target.open || target.count > 3);
}

// Section 5 there, for complexes: vertices on curves count as neighbours of one vertex more, so that a curve is
// contracted along itself, and to no loop of two. Each star for itself: the neighbours in common are those beside the
// edge. A fan of one triangle would vanish, and stays.
template <class Real>
bool Contraction<Real>::keeps_topology_at_joint(const Star& star) const {
    const Vertex& target = mesh_.vertices[static_cast<std::size_t>(star.target())];
    std::size_t added = 0;
    for (std::size_t n = 0; n < count_; ++n) added += parts_[n].star.count;
    if (star.count < 3 || target.count + added > Vertex::kMostTriangles) return false;
    std::array<std::array<std::int32_t, 2>, Vertex::kMostTriangles> sides;  // of the target's triangles
    for (std::size_t n = 0; n < target.count; ++n) {
        const Triangle& triangle = mesh_.triangles[static_cast<std::size_t>(target.ring[n])];
        const std::size_t index = triangle.index_of(star.target());
        sides[n] = {triangle.after(index), triangle.after(index == 2 ? 0 : index + 1)};
    }
    const auto end = sides.begin() + target.count;
    const auto is_neighbour = [&](std::int32_t vertex) {
        return std::any_of(sides.begin(), end, [&](const auto& s) { return s[0] == vertex || s[1] == vertex; });
    };
    std::size_t common = 0;
    for (std::size_t n = 1; n < star.count; ++n) common += static_cast<std::size_t>(is_neighbour(star.neighbours[n]));
    if (common != star.vanishing()) return false;
    const std::int32_t one = star.neighbours[1], other = star.neighbours[2];
    return star.count > 3 || star.vanishing() == 1 || std::none_of(sides.begin(), end, [&](const auto& s) {
               return (s[0] == one && s[1] == other) || (s[0] == other && s[1] == one);
           });
}

// Do all vertices that the curve once had between the two neighbours lie within the limit of the line between them?
// Then every point of either lies within it of the other: between two of those vertices and the places on the line that
// they are nearest to, points of both can be paired in proportion, and distances of pairs are a convex function.
template <class Real>
bool Contraction<Real>::keeps_curve(const Star& star) const {
    const auto place = [&](std::int32_t number) -> const auto& {
        return mesh_.places[static_cast<std::size_t>(number)].at;
    };
    const float limit = limit_here(star);
    const auto is_near = [&](std::int32_t number) {
        return distance_to_line(mesh_.relative(place(star.target()), place(number)),
                                mesh_.relative(place(star.other_end()), place(number))) <= limit;
    };
    if (!is_near(star.centre)) return false;
    for (const std::int32_t next : mesh_.along(star.centre)) {
        std::int32_t from = star.centre, at = next;
        while (mesh_.vertices[static_cast<std::size_t>(at)].count == 0) {
            if (!is_near(at)) return false;
            const auto& along = mesh_.along(at);
            const std::int32_t onward = along[0] == from ? along[1] : along[0];
            from = at;
            at = onward;
        }
    }
    return true;
}

// Until a neighbour of a vertex goes, its triangles are the input's: so a quadric is the same whenever it is made.
template <class Real>
void Contraction<Real>::make_quadrics(const std::vector<std::int32_t>& numbers) {
    const auto make = [&](std::int32_t number) {
        Quadric*& quadric = mesh_.quadrics[static_cast<std::size_t>(number)];
        if (quadric != nullptr) return;
        quadric = quadric_room_.take();
        *quadric = mesh_.planes_around(number);
    };
    for (const std::int32_t number : numbers) {
        const Vertex& vertex = mesh_.vertices[static_cast<std::size_t>(number)];
        for (std::size_t n = 0; n < vertex.count; ++n) {
            for (const std::int32_t corner : mesh_.triangles[static_cast<std::size_t>(vertex.ring[n])].corners)
                make(corner);
        }
    }
}

template <class Real>
void Contraction<Real>::commit() {
    ++collapses;
    const auto centre = static_cast<std::size_t>(parts_[0].star.centre),
               target = static_cast<std::size_t>(parts_[0].star.target());
    for (std::size_t p = 0; p < count_; ++p) take_out(parts_[p]);
    mesh_.quadrics[target]->add(*mesh_.quadrics[centre],
                                mesh_.relative(mesh_.places[target].at, mesh_.places[centre].at));
    quadric_room_.give_back(mesh_.quadrics[centre]);
    mesh_.quadrics[centre] = nullptr;
    for (std::size_t p = 0; p < count_; ++p) draw_faces(parts_[p]);
    for (std::size_t p = 0; p < count_; ++p) join_ring(parts_[p].star);
    room_.give_back(mesh_.vertices[centre].ring, mesh_.vertices[centre].count);
    mesh_.vertices[centre].count = 0;
    mesh_.vertices[centre].movable = false;
    for (std::size_t p = 0; p < count_; ++p) retire(parts_[p].star);
    for (std::size_t p = 0; p < count_; ++p) {
        const Star& star = parts_[p].star;
        for (std::size_t n = 1; n < star.count; ++n) wake(star.neighbours[n], star.target());
    }
}

template <class Real>
void Contraction<Real>::take_out(Part& part) {
    const Star& star = part.star;
    for (const std::int32_t triangle : {star.triangles[0], star.triangles[star.count - 1]}) {
        if (triangle == kNone) continue;
        cubes_.clear();
        grid_.cubes_of(mesh_, triangle, cubes_);
        grid_.remove(triangle, cubes_);
    }
    part.witnesses.hand_over(mesh_, star);
}

template <class Real>
void Contraction<Real>::draw_faces(const Part& part) {
    const Star& star = part.star;
    for (std::size_t n = 1; n + 1 < star.count; ++n) {
        const std::int32_t number = star.triangles[n];
        Triangle& triangle = mesh_.triangles[static_cast<std::size_t>(number)];
        cubes_.clear();
        grid_.cubes_of(mesh_, number, cubes_);
        const std::size_t before = cubes_.size();
        triangle.corners[triangle.index_of(star.centre)] = star.target();
        mesh_.proved[static_cast<std::size_t>(number)] = part.distances[n];
        if (count_ > 1) grid_.cubes_of(mesh_, number, cubes_);
        const std::span<const std::int32_t> cubes(cubes_);
        grid_.move(number, cubes.first(before), count_ > 1 ? cubes.subspan(before) : crossings_.cubes_of_face(n));
    }
}

// The target's ring: where the triangles were that vanish, the faces stand now. A joint's has no order.
template <class Real>
void Contraction<Real>::join_ring(const Star& star) {
    Vertex& target = mesh_.vertices[static_cast<std::size_t>(star.target())];
    const std::int32_t gone = star.triangles[0] == kNone ? star.triangles[star.count - 1] : star.triangles[0];
    const std::size_t faces = star.face_count(), old = target.count, vanishing = star.vanishing();
    const auto first = static_cast<std::size_t>(std::find(target.ring, target.ring + old, gone) - target.ring);
    std::int32_t* const ring = room_.take(old - vanishing + faces);
    const bool is_row = target.open || target.on_curve;
    std::size_t count = 0;
    if (target.is_joint) {
        const auto stays = [&](std::int32_t t) {
            return t != star.triangles[0] && t != star.triangles[star.count - 1];
        };
        count = static_cast<std::size_t>(std::copy_if(target.ring, target.ring + old, ring, stays) - ring);
    } else if (is_row) {
        std::copy_n(target.ring, first, ring);
        count = first;
    }
    for (std::size_t n = 1; n + 1 < star.count; ++n) ring[count++] = star.triangles[n];
    const std::size_t others = target.is_joint ? 0 : is_row ? old - first : old;
    for (std::size_t n = vanishing; n < others; ++n) ring[count++] = target.ring[(first + n) % old];
    room_.give_back(target.ring, old);
    target.ring = ring;
    target.count = static_cast<std::uint16_t>(count);
    target.failed = 0;
}

// The triangles that vanish.
template <class Real>
void Contraction<Real>::retire(const Star& star) {
    const auto drop = [&](std::int32_t triangle, std::int32_t opposite) {
        if (triangle == kNone) return;
        ++vanished;
        mesh_.triangles[static_cast<std::size_t>(triangle)].corners[0] = kNone;
        drop_from_ring(opposite, triangle);
    };
    drop(star.triangles[0], star.neighbours[1]);
    drop(star.triangles[star.count - 1], star.neighbours[star.count - 1]);
}

template <class Real>
void Contraction<Real>::drop_from_ring(std::int32_t number, std::int32_t triangle) {
    Vertex& vertex = mesh_.vertices[static_cast<std::size_t>(number)];
    std::int32_t* const end = vertex.ring + vertex.count;
    std::int32_t* const found = std::find(vertex.ring, end, triangle);
    const auto at = static_cast<std::size_t>(found - vertex.ring);
    std::copy(found + 1, end, found);
    --vertex.count;
    if (at < 64 && !vertex.on_curve) {
        const std::uint64_t below = (std::uint64_t{1} << at) - 1;
        vertex.failed = (vertex.failed & below) | (vertex.failed >> 1 & ~below);
    }
}

// The edge from a neighbour to the target is a new one, and may be tried.
template <class Real>
void Contraction<Real>::wake(std::int32_t number, std::int32_t target) {
    Vertex& vertex = mesh_.vertices[static_cast<std::size_t>(number)];
    if (vertex.odd) return;
    if (vertex.on_curve) {
        const auto ends = mesh_.ends_of(number);
        for (std::size_t n = 0; n < ends.size(); ++n) {
            if (ends[n] == target && count_ > 1) vertex.failed &= ~(std::uint64_t{1} << n);
        }
        return;
    }
    for (std::size_t n = 0; n < vertex.count; ++n) {
        const Triangle& triangle = mesh_.triangles[static_cast<std::size_t>(vertex.ring[n])];
        if (triangle.after(triangle.index_of(number)) == target) {
            vertex.failed &= ~(std::uint64_t{1} << n);
            return;
        }
    }
}

template class Contraction<float>;
template class Contraction<double>;

}  // namespace isocore::simplification
