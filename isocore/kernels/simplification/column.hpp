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

#include "common/vectors.hpp"
#include "simplification/patch.hpp"

namespace isocore::simplification {

class Column {
  public:
    // Does the test prove that all points of a triangle lie within the limit of the patch? The patch's places are those
    // in a frame of the triangle's plane, and so are the triangle's, all at height 0, counter-clockwise seen from
    // above.
    bool is_covered(const std::array<Spot, 3>& triangle, const Patch& patch, float limit);

    // How far, at most.
    float distance() const { return distance_; }

  private:
    // A side of the triangle: where it begins, its way, and how far outside is still taken for inside.
    struct Wall {
        float u, v, along, across, blur;

        // Positive inside.
        template <class Number>
        Number depth(const Number& at_u, const Number& at_v) const {
            return Number(along) * (at_v - Number(v)) - Number(across) * (at_u - Number(u));
        }
    };
    // Heights of eight parts: the lowest is above the highest where there is none.
    struct Range {
        Floats lowest, highest;

        void add(const LaneMask<kRegisterLanes>& where, const Range& other) {
            lowest = choose(where, least(lowest, other.lowest), lowest);
            highest = choose(where, greatest(highest, other.highest), highest);
        }
    };

    void build_walls(const std::array<Spot, 3>& triangle);
    bool add_parts(const Patch& patch, std::size_t first);
    // Of eight triangles, of which u, v and h of each corner are given: what of them lies in the column.
    Range parts(const Vector<Floats>& u, const Vector<Floats>& v, const Vector<Floats>& h) const;
    void add_sides(const Vector<Floats>& u, const Vector<Floats>& v, const Vector<Floats>& h, Range& out) const;
    void add_corners(const Vector<Floats>& u, const Vector<Floats>& v, const Vector<Floats>& h, Range& out) const;
    bool is_odd_at(float share, float other_share) const;

    std::array<Wall, 3> walls_{};
    float extent_ = 0;  // of the triangle's coordinates, at most
    float limit_ = 0, distance_ = 0;
    // Of the triangles with parts within the limit: u and v of each corner.
    std::array<std::vector<float>, 6> places_;
    std::size_t count_ = 0;
};

}  // namespace isocore::simplification
