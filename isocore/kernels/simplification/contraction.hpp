// contraction.hpp - Contracts an edge of the mesh onto one of its ends, where all rules allow it. README.md lists the
// rules; they are asked in the order of what they cost.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "simplification/backward.hpp"
#include "simplification/crossings.hpp"
#include "simplification/outward.hpp"
#include "simplification/star.hpp"
#include "simplification/triangle_grid.hpp"

namespace isocore::simplification {

// A thread has one, and what it needs for itself.
template <class Real>
class Contraction {
  public:
    Contraction(Mesh<Real>& mesh, const Reference<Real>& reference, TriangleGrid& grid, float limit)
        : mesh_(mesh),
          grid_(grid),
          limit_(limit),
          backward_(reference, mesh),
          crossings_(mesh, grid),
          refused_(reference.mesh().sheet_count + 1) {}

    // Contracts the edge from the ring's centre to its neighbour `target` onto that neighbour. False if a rule forbids
    // it; then nothing has changed. Of a vertex on a curve, the ring holds nothing but the neighbours there.
    bool contract(const Ring& ring, std::size_t target);
    // The quadrics of some vertices that may move and of their neighbours, where they are not there yet.
    void make_quadrics(const std::vector<std::int32_t>& vertices);
    // The mesh and the grid were filled anew.
    void start_over() {
        room_ = {};
        quadric_room_ = {};
        crossings_.start_over();
    }
    // The grid alone was.
    void look_through_new_grid() { crossings_.start_over(); }
    // From now on.
    void set_limit(float limit) { limit_ = limit; }
    float limit() const { return limit_; }
    // Of the last contraction: its star, or one for each sheet that meets on the curve.
    const Star& star(std::size_t n) const { return parts_[n].star; }
    std::size_t star_count() const { return count_; }
    Backward<Real>& backward() { return backward_; }

    std::size_t collapses = 0, vanished = 0;  // edges, and triangles
    // By sheet.
    const std::vector<std::array<std::size_t, kRules>>& refused() const { return refused_; }

  private:
    // A star, and what was found out about its faces.
    struct Part {
        Star star;
        Facets facets;
        Witnesses witnesses;
        std::array<float, Ring::kRoom> distances;
    };

    bool refuse(Rule rule, const Star& star) {
        ++refused_[star.sheet][static_cast<std::size_t>(rule)];
        return false;
    }
    void gather_fans(std::int32_t vertex, std::int32_t target);
    void fetch_target() const;
    bool are_allowed();
    bool are_apart();
    bool keeps_topology(const Star& star) const;
    bool keeps_topology_at_joint(const Star& star) const;
    bool keeps_curve(const Star& star) const;
    float limit_here(const Star& star) const;
    void commit();
    void take_out(Part& part);
    void draw_faces(const Part& part);
    void join_ring(const Star& star);
    void retire(const Star& star);
    void drop_from_ring(std::int32_t vertex, std::int32_t triangle);
    void wake(std::int32_t vertex, std::int32_t target);

    Mesh<Real>& mesh_;
    TriangleGrid& grid_;
    float limit_;
    std::vector<Part> parts_{1};
    std::size_t count_ = 1;
    std::vector<const Star*> others_;
    Backward<Real> backward_;
    Crossings<Real> crossings_;
    RingRoom room_;
    QuadricRoom quadric_room_;
    std::vector<std::int32_t> cubes_;
    std::vector<std::array<std::size_t, kRules>> refused_;
};

}  // namespace isocore::simplification
