// backward.hpp - The bound backward: how far the points of a triangle, all of them, lie from the reference. What is
// found is proved, not sampled: README.md says how.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "common/facets.hpp"
#include "simplification/column.hpp"
#include "simplification/patch.hpp"
#include "simplification/reference.hpp"
#include "simplification/star.hpp"

namespace isocore::simplification {

template <class Real>
class Backward {
  public:
    Backward(const Reference<Real>& reference, const Mesh<Real>& mesh) : reference_(reference), mesh_(mesh) {}

    // Without it, a limit of more than kFarthest is not proved to be kept: are_near() then says yes, and distance()
    // infinity.
    void prove_all(bool all) { proves_all_ = all; }
    static constexpr float kFarthest = 4;  // cells
    bool is_provable(float limit) const { return proves_all_ || limit <= kFarthest; }

    // Stars are now asked about whose vertices lie in these cells, both included.
    void enter_box(const Cell& low, const Cell& high, float limit);
    // Or anywhere.
    void leave_box() { rows_.forget(); }

    // Is it proved that all points of the star's faces lie within the limit of the reference? facets: star.draw()'s.
    bool are_near(const Star& star, const Facets& facets, float limit);
    // Of each face of that star: how far its points lie from the reference, at most.
    float distance(std::size_t face) const { return distances_[face - 1]; }
    // The same of one triangle of the mesh: at most so far, or infinity where it is not proved to lie within the limit.
    float distance(std::int32_t triangle, float limit);

  private:
    using Corners = std::array<Spot, 3>;
    // A bit for each triangle of the patch: does a point lie within the limit of it? Only the first words_ are used.
    static constexpr std::size_t kMostTriangles = Facets::kRoom;
    using Within = std::array<std::uint64_t, kMostTriangles / 64>;
    using OfCorners = std::array<const Within*, 3>;

    bool is_near(const Corners& triangle, const Facets::Frame& frame);
    bool is_near(const Corners& triangle, std::size_t depth);
    void take_facets(const Corners& triangle, Patch& near);
    bool is_near_by_pieces(const Corners& triangle);
    bool is_near_by_halves(const Corners& triangle, const OfCorners& within, int depth);
    bool find_within(const Spot& point, Within& out) const;

    const Reference<Real>& reference_;
    const Mesh<Real>& mesh_;
    bool proves_all_ = true;
    float limit_ = 0;
    Rows rows_;
    Patch near_star_;
    std::array<Patch, 4> near_;  // by depth
    std::vector<float> distances_;
    std::vector<std::pair<float, std::size_t>> order_;  // of faces: how likely they are to be far, and which
    float distance_ = 0;                                // so far, of the triangle that is looked at
    Column column_;
    bool is_plumbed_ = true;  // are places seen from the triangle that is looked at?
    Facets frame_, facets_;
    std::size_t words_ = 0;
    int halvings_ = 0;  // that may still be done
};

}  // namespace isocore::simplification
