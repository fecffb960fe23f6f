// tet_pen.hpp - Draws one tetrahedron without a branch: what is written for every pattern of corner signs stands in a
// table of picks, and always as much of it as there can be at most.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "common/mesh_field.hpp"
#include "tables/mesh_cases.hpp"
#include "thinning/mesh/fours.hpp"
#include "thinning/mesh/scratch.hpp"

namespace isocore::thinning {

template <class Value>
class TetPen {
  public:
    static constexpr std::size_t kMostEdges = 4, kMostCorners = 8;  // written, of which two are never meant

    TetPen(const mesh::Field<Value>&, double) : cases_(cases().data()) {}

    // Writes the crossed edges and returns how many there are.
    std::size_t write_edges(mesh::Mask signs, const std::int32_t* corners, EdgeKey* out) const {
        const Case& it = cases_[signs];
        thinning::write_edges(corners, it.from, it.to, out);
        return it.edges;
    }

    struct Written {
        std::size_t edges, corners;
    };

    // Writes the corners of the triangles, from the places of the crossed edges.
    Written write_triangles(mesh::Mask signs, const std::int32_t*, const std::uint32_t* places, std::uint32_t* out,
                            Drawn&) const {
        const Case& it = cases_[signs];
        write_four(places, it.first, out);
        write_four(places, it.last, out + 4);
        return {it.edges, it.corners};
    }

  private:
    struct Case {
        Pick from, to;     // the ends of the crossed edges, among the corners
        Pick first, last;  // the corners of the triangles, among the crossed edges
        std::uint8_t edges = 0, corners = 0;
    };

    static const std::array<Case, 16>& cases() {
        static const std::array<Case, 16> all = [] {
            std::array<Case, 16> made{};
            for (std::size_t signs = 0; signs < made.size(); ++signs) made[signs] = make_case(signs);
            return made;
        }();
        return all;
    }

    static Case make_case(std::size_t signs) {
        const mesh::Mask crossed = mesh::kCrossedEdges<mesh::Tet>[signs];
        std::array<std::uint8_t, kMostEdges> from{}, to{};
        Case made;
        for (mesh::Mask left = crossed; left != 0; left &= left - 1) {
            const auto& ends = mesh::Tet::kShape.ends[static_cast<std::size_t>(std::countr_zero(left))];
            from[made.edges] = ends[0];
            to[made.edges++] = ends[1];
        }
        const mesh::TetCase& drawn = mesh::kTetCases[signs];
        made.corners = static_cast<std::uint8_t>(3 * drawn.triangles);
        std::array<std::array<std::uint8_t, 4>, 2> numbers{};
        for (std::size_t n = 0; n < made.corners; ++n) {
            const mesh::Mask before = crossed & ((mesh::Mask{1} << drawn.edges[n]) - 1);
            numbers[n / 4][n % 4] = static_cast<std::uint8_t>(std::popcount(before));
        }
        made.from = Pick(from);
        made.to = Pick(to);
        made.first = Pick(numbers[0]);
        made.last = Pick(numbers[1]);
        return made;
    }

    const Case* cases_;
};

}  // namespace isocore::thinning
