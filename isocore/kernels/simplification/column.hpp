// column.hpp - The plumb test: is a triangle covered by the reference, in its own direction, within a limit?
//
// The column over a triangle is all that lies straight above and below it, in the direction of its normal. Look at the
// parts of the reference in the column. If each lies either within the limit of the triangle's plane or beyond it
// altogether, then the reference enters or leaves the slab within the limit nowhere over the triangle; and if it does
// not end there either, the number of times that it covers a point, within the limit, is odd for all points of the
// triangle or for none. Odd at one point: all points are covered.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "common/facets.hpp"
#include "simplification/patch.hpp"

namespace isocore::simplification {

class Column {
  public:
    // Does the test prove that all points of the triangle with this frame lie within the limit of the patch?
    bool is_covered(const Facets::Frame& frame, const Patch& patch, float limit);

    // How far, at most.
    float distance() const { return distance_; }

  private:
    // A place beside the triangle: along its first side, across it, and above it.
    struct Height {
        float u, v, h;
    };
    enum class Part { none, within, beyond, across };

    bool add_parts(const Patch& patch, std::size_t first);
    unsigned has_low_plane(const Vector<Floats>& u, const Vector<Floats>& v, const Vector<Floats>& h) const;
    unsigned apart(const Vector<Floats>& u, const Vector<Floats>& v) const;
    Part part_of(const std::array<Height, 3>& triangle) const;
    bool is_odd_at(float share, float other_share) const;

    Facets::Frame frame_;
    float limit_ = 0, distance_ = 0;
    // Of the triangles with parts within the limit: u and v of each corner.
    std::array<std::vector<float>, 6> places_;
    std::size_t count_ = 0;
};

}  // namespace isocore::simplification
