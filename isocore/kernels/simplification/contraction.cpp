#include "simplification/contraction.hpp"

#include <algorithm>

namespace isocore::simplification {

template <class Real>
bool Contraction<Real>::contract(const Ring& ring, std::size_t target) {
    star_.turn(ring, target);
    if (!keeps_topology()) return refuse(Rule::link);
    if (!star_.has_good_shapes()) return refuse(Rule::shape);
    star_.draw(facets_);
    const float limit = limit_here();
    witnesses_.gather(mesh_, star_);
    if (!witnesses_.are_near(facets_, limit)) return refuse(Rule::outward);
    if (!backward_.are_near(star_, limit)) return refuse(Rule::back);
    if (crossings_.are_there(star_, facets_)) return refuse(Rule::crossing);
    commit();
    return true;
}

// The limit, less what rounding may have done to places that are so far apart.
template <class Real>
float Contraction<Real>::limit_here() const {
    return limit_ - 2e-6f * (1 + star_.reach() + limit_);
}

// The link condition of T. K. Dey, H. Edelsbrunner, S. Guha, D. V. Nekhayev, "Topology preserving edge contraction",
// 1999: the two ends have no other neighbours in common than the two beside the edge, and are not two corners of a
// tetrahedron.
template <class Real>
bool Contraction<Real>::keeps_topology() const {
    const Vertex& target = mesh_.vertices[static_cast<std::size_t>(star_.target())];
    if (target.odd || star_.count < 3 || target.count + star_.count > Vertex::kMostTriangles + 4) return false;
    std::array<std::int32_t, Vertex::kMostTriangles + 1> around;
    std::size_t count = 0;
    for (std::size_t n = 0; n < target.count; ++n) {
        const Triangle& triangle = mesh_.triangles[static_cast<std::size_t>(target.ring[n])];
        const std::size_t index = triangle.index_of(star_.target());
        around[count++] = triangle.after(index);
        if (target.open && n + 1 == target.count) around[count++] = triangle.after(index == 2 ? 0 : index + 1);
    }
    std::size_t common = 0;
    for (std::size_t n = 1; n < star_.count; ++n)
        common += static_cast<std::size_t>(std::count(around.begin(), around.begin() + count, star_.neighbours[n]));
    return common == 2 && (star_.count > 3 || target.open || target.count > 3);
}

template <class Real>
void Contraction<Real>::commit() {
    ++collapses;
    for (std::size_t n = 0; n < star_.count; ++n) {
        cubes_.clear();
        grid_.cubes_of(mesh_, star_.triangles[n], cubes_);
        grid_.remove(star_.triangles[n], cubes_.data(), cubes_.size(), spare_);
    }
    witnesses_.hand_over(mesh_, star_);
    const auto centre = static_cast<std::size_t>(star_.centre), target = static_cast<std::size_t>(star_.target());
    mesh_.quadrics[target].add(mesh_.quadrics[centre],
                               mesh_.relative(mesh_.places[target].at, mesh_.places[centre].at));
    enter_faces();
    join_rings();
}

template <class Real>
void Contraction<Real>::enter_faces() {
    for (std::size_t n = 1; n + 1 < star_.count; ++n) {
        const std::int32_t number = star_.triangles[n];
        Triangle& triangle = mesh_.triangles[static_cast<std::size_t>(number)];
        triangle.corners[triangle.index_of(star_.centre)] = star_.target();
        mesh_.proved[static_cast<std::size_t>(number)] = backward_.distance(n);
        const std::size_t first = crossings_.first_cube(n);
        grid_.enter(number, crossings_.cubes_of_faces().data() + first, crossings_.end_cube(n) - first, spare_);
    }
}

// The target's ring: where the two triangles were that vanish, the faces stand now.
template <class Real>
void Contraction<Real>::join_rings() {
    Vertex& target = mesh_.vertices[static_cast<std::size_t>(star_.target())];
    const std::int32_t gone = star_.triangles[0], also_gone = star_.triangles[star_.count - 1];
    const std::size_t faces = star_.face_count(), old = target.count;
    const auto first = static_cast<std::size_t>(std::find(target.ring, target.ring + old, gone) - target.ring);
    std::int32_t* const ring = room_.take(old - 2 + faces);
    std::size_t count = 0;
    if (target.open) std::copy_n(target.ring, first, ring);
    if (target.open) count = first;
    for (std::size_t n = 1; n + 1 < star_.count; ++n) ring[count++] = star_.triangles[n];
    const std::size_t others = target.open ? old - first : old;
    for (std::size_t n = 2; n < others; ++n) ring[count++] = target.ring[(first + n) % old];
    target.ring = ring;
    target.count = static_cast<std::uint16_t>(count);
    target.failed = 0;

    for (const std::int32_t triangle : {gone, also_gone})
        mesh_.triangles[static_cast<std::size_t>(triangle)].corners[0] = kNone;
    Vertex& centre = mesh_.vertices[static_cast<std::size_t>(star_.centre)];
    centre.count = 0;
    centre.movable = false;
    drop_from_ring(star_.neighbours[1], gone);
    drop_from_ring(star_.neighbours[star_.count - 1], also_gone);
    for (std::size_t n = 1; n < star_.count; ++n) wake(star_.neighbours[n]);
}

template <class Real>
void Contraction<Real>::drop_from_ring(std::int32_t number, std::int32_t triangle) {
    Vertex& vertex = mesh_.vertices[static_cast<std::size_t>(number)];
    std::int32_t* const end = vertex.ring + vertex.count;
    std::int32_t* const found = std::find(vertex.ring, end, triangle);
    const auto at = static_cast<std::size_t>(found - vertex.ring);
    std::copy(found + 1, end, found);
    --vertex.count;
    if (at < 64) {
        const std::uint64_t below = (std::uint64_t{1} << at) - 1;
        vertex.failed = (vertex.failed & below) | (vertex.failed >> 1 & ~below);
    }
}

// The edge from a neighbour to the target is a new one, and may be tried.
template <class Real>
void Contraction<Real>::wake(std::int32_t number) {
    Vertex& vertex = mesh_.vertices[static_cast<std::size_t>(number)];
    if (vertex.odd) return;
    for (std::size_t n = 0; n < vertex.count; ++n) {
        const Triangle& triangle = mesh_.triangles[static_cast<std::size_t>(vertex.ring[n])];
        if (triangle.after(triangle.index_of(number)) == star_.target()) {
            vertex.failed &= ~(std::uint64_t{1} << n);
            return;
        }
    }
}

template class Contraction<float>;
template class Contraction<double>;

}  // namespace isocore::simplification
