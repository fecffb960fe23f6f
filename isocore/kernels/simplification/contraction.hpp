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
        : mesh_(mesh), grid_(grid), limit_(limit), backward_(reference, mesh), crossings_(mesh, grid) {}

    // Contracts the edge from the ring's centre to its neighbour `target` onto that neighbour. False if a rule forbids
    // it; then nothing has changed.
    bool contract(const Ring& ring, std::size_t target);
    // From now on.
    void set_limit(float limit) { limit_ = limit; }
    // The star of the last contraction.
    const Star& star() const { return star_; }
    Backward<Real>& backward() { return backward_; }

    std::size_t collapses = 0;
    std::array<std::size_t, kRules> refused{};

  private:
    bool refuse(Rule rule) {
        ++refused[static_cast<std::size_t>(rule)];
        return false;
    }
    bool keeps_topology() const;
    float limit_here() const;
    void commit();
    void enter_faces();
    void join_rings();
    void drop_from_ring(std::int32_t vertex, std::int32_t triangle);
    void wake(std::int32_t vertex);

    Mesh<Real>& mesh_;
    TriangleGrid& grid_;
    float limit_;
    Star star_;
    Facets facets_;
    Witnesses witnesses_;
    Backward<Real> backward_;
    Crossings<Real> crossings_;
    RingRoom room_;
    TriangleGrid::Spare spare_;
    std::vector<std::int32_t> cubes_;
};

}  // namespace isocore::simplification
