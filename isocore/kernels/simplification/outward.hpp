// outward.hpp - The bound outward: how far the reference's vertices lie from the surface. Follows R. Klein, G. Liebich,
// W. Strasser, "Mesh Reduction with Error Control", IEEE Visualization 1996: each of them is kept with the triangle
// that it is nearest to, as its witness, and moves on when that is replaced.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/facets.hpp"
#include "simplification/cells.hpp"
#include "simplification/mesh.hpp"
#include "simplification/star.hpp"
#include "simplification/triangle_grid.hpp"

namespace isocore::simplification {

// The witnesses of a star.
class Witnesses {
  public:
    // Takes those of the star's triangles, and the star's centre, which becomes one, unless it lies on a curve: then it
    // is one already, of each sheet there.
    template <class Real>
    void gather(const Mesh<Real>& mesh, const Ring& ring);
    // Does each lie within the limit of one of these facets? Keeps in mind of which it is nearest to.
    bool are_near(const Facets& facets, float limit);
    // Hands each to the triangle that face n - 1 of the star is drawn as, once are_near() has held.
    template <class Real>
    void hand_over(Mesh<Real>& mesh, const Star& star) const;

  private:
    void make_room(std::size_t room);

    std::size_t count_ = 0;
    std::vector<std::int32_t> numbers_;
    Vector<std::vector<float>> places_;
    std::vector<float> nearest_;
};

}  // namespace isocore::simplification
