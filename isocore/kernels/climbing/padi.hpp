// padi.hpp - A padi is the rectangle that two highrices share, a lign of cells thick on neither side: all its ligns are
// simple, so one iso-line crosses it. The iso-lines of a whole box face form one path, which no lign meets twice, so it
// runs one way along both axes: the kept edges in the face, row by row, are the rims of the padis in their order.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "climbing/high_rice.hpp"
#include "climbing/layout.hpp"
#include "climbing/site.hpp"
#include "common/cube.hpp"

namespace isocore::climbing {

// A crossed grid edge: its axis and its lower sample.
struct RimEdge {
    int axis;
    Place at;
};

// The crossed edges of a box, by its corner signs.
inline constexpr std::array<std::uint16_t, 256> kCrossed = [] {
    std::array<std::uint16_t, 256> crossed{};
    for (unsigned corners = 0; corners < 256; ++corners) {
        for (int edge = 0; edge < 12; ++edge) {
            const unsigned low = corners >> cube::low_corner(edge) & 1, high = corners >> cube::high_corner(edge) & 1;
            crossed[corners] |= static_cast<std::uint16_t>((low ^ high) << edge);
        }
    }
    return crossed;
}();

// The one crossing on a crossed edge of a simple box.
inline RimEdge box_crossing(const Site& site, const HighRice& box, int edge) {
    const int axis = edge / 4, corner = cube::low_corner(edge);
    const auto a = static_cast<std::size_t>(axis);
    RimEdge out{axis, {}};
    for (std::size_t n = 0; n < 3; ++n) out.at[n] = corner >> n & 1 ? box.high[n] : box.low[n];
    const std::uint64_t signs = site.lign(axis, out.at);
    out.at[a] = std::countr_zero((signs ^ signs >> 1) & ~std::uint64_t{0} << box.low[a]);
    return out;
}

// Makes vertices of the crossings on the edges of a box; calls visit(number, lower sample) for those that were none.
template <class Visit>
void keep_edges(const Site& site, const HighRice& box, Layout& layout, const Visit& visit) {
    for (unsigned left = kCrossed[site.corners(box)]; left; left &= left - 1) {
        const RimEdge edge = box_crossing(site, box, std::countr_zero(left));
        const std::size_t number = site.crossing(edge.axis, edge.at);
        if (layout.keep(number)) visit(number, edge.at);
    }
}

namespace padi {

// Calls visit(edge) for the kept edges within a face, from the crossing `from` on its rim to the crossing `to`.
template <class Visit>
void walk_face(const Site& site, const HighRice& box, int face, const RimEdge& from, const RimEdge& to, const Visit& visit) {
    const int normal = face / 2;
    const auto across = cube::other_axes(normal);
    const auto u = static_cast<std::size_t>(across[0]), v = static_cast<std::size_t>(across[1]);
    if (box.length(u) + box.length(v) == 2) return;
    const int fixed = face & 1 ? box.high[static_cast<std::size_t>(normal)] : box.low[static_cast<std::size_t>(normal)];
    const std::uint64_t below_high = (std::uint64_t{1} << box.high[u]) - 1;
    const std::uint64_t along = below_high & ~std::uint64_t{0} << box.low[u], within = along & ~std::uint64_t{1} << box.low[u];
    const auto place = [](const RimEdge& edge, std::size_t axis) { return 2 * edge.at[axis] + (static_cast<int>(axis) == edge.axis); };
    const bool falls = place(to, v) < place(from, v), turns_back = place(to, u) < place(from, u);

    const auto tell = [&](std::size_t axis, int bit, int n) {
        RimEdge edge{static_cast<int>(axis), {}};
        edge.at[static_cast<std::size_t>(normal)] = fixed;
        edge.at[u] = bit;
        edge.at[v] = n;
        visit(edge);
    };
    const auto across_line = [&](int n) {
        std::uint64_t left = site.kept_on_plane(normal, fixed, across[1], n) & within;
        while (left) {
            const int bit = turns_back ? 63 - std::countl_zero(left) : std::countr_zero(left);
            left ^= std::uint64_t{1} << bit;
            tell(v, bit, n);
        }
    };
    const auto on_line = [&](int n) {
        if (const std::uint64_t found = site.kept_on_plane(normal, fixed, across[0], n) & along) tell(u, std::countr_zero(found), n);
    };
    if (falls) {
        for (int n = std::min<int>(from.at[v], box.high[v] - 1); n >= to.at[v]; --n) {
            across_line(n);
            if (n > box.low[v]) on_line(n);
        }
    } else {
        for (int n = from.at[v]; n <= to.at[v] && n < box.high[v]; ++n) {
            if (n > box.low[v]) on_line(n);
            across_line(n);
        }
    }
}

// The loop of a disk box: calls visit(edge, faces of the box that the edge lies on) for every vertex on its surface, in
// the order that turns its triangles outwards.
template <class Visit>
void walk_loop(const Site& site, const HighRice& box, const Rim& rim, const Visit& visit) {
    std::array<RimEdge, 7> ends;
    for (unsigned n = 0; n < rim.length; ++n) ends[n] = box_crossing(site, box, rim.edges[n]);
    ends[rim.length] = ends[0];
    for (unsigned n = 0; n < rim.length; ++n) {
        visit(ends[n], unsigned{kFacesOfEdge[rim.edges[n]]});
        walk_face(site, box, rim.faces[n], ends[n], ends[n + 1], [&](const RimEdge& edge) { visit(edge, 1u << rim.faces[n]); });
    }
}

}  // namespace padi
}  // namespace isocore::climbing
