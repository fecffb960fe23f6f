// star.hpp - A vertex and the ring of its neighbours, copied close together, and the faces that are drawn instead once
// it is contracted onto one of them. Places are relative to the vertex, and stretched.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "common/facets.hpp"
#include "common/lanes.hpp"
#include "simplification/mesh.hpp"

namespace isocore::simplification {

// A vertex inside the surface. Triangle n lies between neighbours n and n + 1, the last between it and neighbour 0.
//
// A fan of a vertex on a curve is a ring, too: from one neighbour on the curve to the other, and then a triangle that
// is not there, kNone.
struct Ring {
    static constexpr std::size_t kRoom = Vertex::kMostTriangles + 2 * kLanes;

    std::int32_t centre = kNone;
    std::size_t count = 0;
    std::uint32_t sheet = 0;
    std::array<std::int32_t, kRoom> neighbours, triangles;
    Vector<std::array<float, kRoom>> places;

    template <class Real>
    void gather(const Mesh<Real>& mesh, std::int32_t vertex);
    // Takes one fan: triangles `begin` to `end` - 1 of the vertex's ring.
    template <class Real>
    void gather_fan(const Mesh<Real>& mesh, std::int32_t vertex, std::size_t begin, std::size_t end);
    // Takes nothing but the two neighbours on the curve.
    template <class Real>
    void gather_ends(const Mesh<Real>& mesh, std::int32_t vertex);

    Spot place(std::size_t n) const { return {places[0][n], places[1][n], places[2][n]}; }
    Vector<Floats> in_lanes(std::size_t n) const {
        return {Floats(places[0].data() + n), Floats(places[1].data() + n), Floats(places[2].data() + n)};
    }

  private:
    template <class Real>
    void take_neighbour(const Mesh<Real>& mesh, std::size_t n, std::int32_t neighbour);
};

// The ring, turned so that neighbour 0 is the target. Triangle 0 and the last one vanish; face n, from 1 to count - 2,
// is drawn instead of triangle n: target, neighbour n, neighbour n + 1. Of a fan, one of the two that vanish is not
// there.
class Star : public Ring {
  public:
    void turn(const Ring& ring, std::size_t target);

    std::int32_t target() const { return neighbours[0]; }
    std::size_t face_count() const { return count - 2; }
    // Of a fan: the vertex's other neighbour on the curve.
    std::int32_t other_end() const { return neighbours[triangles[0] == kNone ? 1 : count - 1]; }
    // The triangles that vanish and are there: one of a fan, else two.
    std::size_t vanishing() const { return triangles[0] == kNone || triangles[count - 1] == kNone ? 1 : 2; }
    bool has(std::int32_t triangle) const {
        return std::find(triangles.begin(), triangles.begin() + count, triangle) != triangles.begin() + count;
    }

    // No face is turned far from the triangle that it replaces, or from the whole star where that was a sliver, whose
    // direction means little; and none is a sliver, unless a worse one was.
    bool has_good_shapes() const;
    // The faces as facets: face n has number n - 1.
    void draw(Facets& facets) const;
    // How far the farthest neighbour is away, at most.
    float reach() const;

  private:
    Spot doubled_area() const;
};

}  // namespace isocore::simplification
