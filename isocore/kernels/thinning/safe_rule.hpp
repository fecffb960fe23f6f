// safe_rule.hpp - May a cell be removed? Let A be the part of its boundary that remaining cells still use. Removing it
// is safe iff A is connected and not empty: then what remains keeps every component and every loop
// (docs/proofs/thinning.md, section 3).
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "common/mesh_cells.hpp"

namespace isocore::thinning {

using mesh::Mask;

// The set A of a cell: its corners and edges that other remaining cells touch, and its faces that a remaining cell
// shares.
struct Used {
    Mask corners = 0, edges = 0, faces = 0;
    // The Euler number V - E + F of A. The cell's boundary is a sphere, so a connected A leaves 2 - euler() pieces
    // free.
    int euler() const { return std::popcount(corners) - std::popcount(edges) + std::popcount(faces); }
};

// Is A connected and not empty? A holds every edge of its faces and both ends of its edges, so corners and edges
// suffice.
template <class Cell>
constexpr bool connected(Mask corners, Mask edges) {
    if (corners == 0) return false;
    Mask reached = corners & (0u - corners);
    for (Mask before = 0; before != reached;) {
        before = reached;
        for (Mask left = edges; left != 0; left &= left - 1) {
            const auto& ends = Cell::kShape.ends[static_cast<std::size_t>(std::countr_zero(left))];
            const Mask both = Mask{1} << ends[0] | Mask{1} << ends[1];
            if (reached & both) reached |= both;
        }
    }
    return reached == corners;
}

// The same as a table for tetrahedra: bit c of entry e is the answer for the set c of corners and the set e of edges.
inline constexpr auto kTetConnected = [] {
    std::array<std::uint16_t, 64> table{};
    for (Mask edges = 0; edges < 64; ++edges) {
        for (Mask corners = 0; corners < 16; ++corners) {
            if (connected<mesh::Tet>(corners, edges))
                table[edges] = static_cast<std::uint16_t>(table[edges] | 1u << corners);
        }
    }
    return table;
}();

inline bool is_connected(mesh::Tet, const Used& used) { return kTetConnected[used.edges] >> used.corners & 1; }
inline bool is_connected(mesh::Hex, const Used& used) { return connected<mesh::Hex>(used.corners, used.edges); }

}  // namespace isocore::thinning
