// derive_loops.hpp - From corner signs and face decisions to loops, and from loops to triangles: how the tables of
// cases are derived. Included where a table is derived or proved, and nowhere else: what is evaluated here takes the
// compiler seconds.
//
// Every face pairs its crossings by its own four corners and, where these alternate, by whether its inside corners are
// joined. So the segments close to loops, and the cell across the face draws the same segments the other way round.
//
// A loop is cut into triangles by diagonals. A diagonal between two edges of one face lies in that face, and if the
// cell across drew the same one, four triangles would share it. So such diagonals are avoided where they can be; where
// not, they are shared out: between crossings on parallel edges only to the cell above the face, between those on
// adjacent edges only to the cell below. Then every loop can be cut without a vertex in its middle, and no two
// diagonals cross: that takes both pairs of parallel edges, and no cell needs both.
//
// Cells of an unstructured mesh have no above and below, so their table (mesh_cases.cpp) draws no diagonal in a face at
// all: a loop that cannot be cut so gets a vertex in its middle.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "common/cube.hpp"
#include "tables/cell_loops.hpp"

namespace isocore::cell_loops::derivation {

enum class FaceDiagonals { shared_out, none };

// The loops of a case: the edges of each, in order.
struct Loops {
    std::array<std::array<int, 12>, 4> edges{};
    std::array<int, 4> lengths{};
    int count = 0;
};

// For each crossed edge the edge its segment leads to. Seen from outside the cell a segment runs from where the face's
// rim enters the inside to where it left it: the last time if the inside corners are joined, else the next time.
constexpr std::array<int, 12> segments(unsigned corners, unsigned joined) {
    std::array<int, 12> next{};
    next.fill(-1);
    for (int face = 0; face < 6; ++face) {
        const auto ring = cube::face_ring(face);
        const auto in = [&](int n) { return (corners >> ring[static_cast<unsigned>(n & 3)] & 1) != 0; };
        const auto edge = [&](int n) {
            return cube::edge_between(ring[static_cast<unsigned>(n & 3)], ring[static_cast<unsigned>((n + 1) & 3)]);
        };
        const bool isolated = cube::alternates(corners, face) && !(joined >> face & 1);
        for (int n = 0; n < 4; ++n) {
            if (!in(n) || in(n + 1)) continue;
            int entry = isolated ? n + 3 : n + 1;
            while (in(entry) || !in(entry + 1)) ++entry;
            next[static_cast<unsigned>(edge(entry))] = edge(n);
        }
    }
    return next;
}

// Follows the segments from edge to edge, which closes all loops. `joined`: a bit per face, set if its inside corners
// are joined; it matters for ambiguous faces only.
constexpr Loops trace(unsigned corners, unsigned joined) {
    const auto next = segments(corners, joined);
    Loops loops;
    unsigned seen = 0;
    for (int start = 0; start < 12; ++start) {
        if (next[static_cast<unsigned>(start)] < 0 || (seen >> start & 1)) continue;
        const auto loop = static_cast<unsigned>(loops.count++);
        for (int edge = start; !(seen >> edge & 1); edge = next[static_cast<unsigned>(edge)]) {
            seen |= 1u << edge;
            loops.edges[loop][static_cast<unsigned>(loops.lengths[loop]++)] = edge;
        }
    }
    return loops;
}

// The penalties of a diagonal in a face that this cell may draw, and of one that it must leave to the cell across. The
// first is more than all other diagonals of a loop cost together, the second more than all of the first kind.
inline constexpr int kInFace = 1'000, kForbidden = 1'000'000;

// The cost of a diagonal between two crossed edges: its squared length, measured in half cells, plus a penalty where it
// lies in a face.
constexpr int diagonal_cost(int a, int b, FaceDiagonals rule) {
    int cost = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const auto place = [&](int edge) { return edge / 4 == axis ? 1 : 2 * (cube::low_corner(edge) >> axis & 1); };
        cost += (place(a) - place(b)) * (place(a) - place(b));
    }
    const int face = cube::shared_face(a, b);
    if (face < 0) return cost;
    if (rule == FaceDiagonals::none) return cost + kForbidden;
    const bool for_cell_above = a / 4 == b / 4;
    const bool cell_is_above = (face & 1) == 0;
    return cost + (for_cell_above == cell_is_above ? kInFace : kForbidden);
}

// Adds the cheapest triangulation of one loop to a case, by dynamic programming over its sub-polygons: cost[i][j] is
// that of the polygon from corner i to corner j, and apex[i][j] the third corner of the triangle on its side (i, j).
template <class AnyCase>
constexpr void triangulate(const std::array<int, 12>& loop, int length, FaceDiagonals rule, AnyCase& out) {
    const auto draw = [&](int a, int b, int c) {
        const auto place = static_cast<unsigned>(3 * out.triangles++);
        out.edges[place] = static_cast<std::uint8_t>(a);
        out.edges[place + 1] = static_cast<std::uint8_t>(b);
        out.edges[place + 2] = static_cast<std::uint8_t>(c);
    };
    std::array<std::array<int, 12>, 12> cost{}, apex{};
    const auto chord = [&](int i, int j) {
        const bool is_side = j - i == 1 || (i == 0 && j == length - 1);
        return is_side ? 0 : diagonal_cost(loop[static_cast<unsigned>(i)], loop[static_cast<unsigned>(j)], rule);
    };
    for (int span = 2; span < length; ++span) {
        for (int i = 0; i + span < length; ++i) {
            const int j = i + span;
            int best = -1;
            for (int k = i + 1; k < j; ++k) {
                const int through_k = cost[static_cast<unsigned>(i)][static_cast<unsigned>(k)] + chord(i, k) +
                                      cost[static_cast<unsigned>(k)][static_cast<unsigned>(j)] + chord(k, j);
                if (best < 0 || through_k < best) {
                    best = through_k;
                    apex[static_cast<unsigned>(i)][static_cast<unsigned>(j)] = k;
                }
            }
            cost[static_cast<unsigned>(i)][static_cast<unsigned>(j)] = best;
        }
    }
    if (cost[0][static_cast<unsigned>(length - 1)] >= kForbidden) {
        if (rule != FaceDiagonals::none) throw "a loop has no legal triangulation";
        const int middle = 12 + out.middles++;
        for (int i = 0; i < length; ++i)
            draw(loop[static_cast<unsigned>(i)], loop[static_cast<unsigned>((i + 1) % length)], middle);
        return;
    }
    std::array<std::array<int, 2>, 24> open{};
    int waiting = 0;
    open[static_cast<unsigned>(waiting++)] = {0, length - 1};
    while (waiting > 0) {
        const auto [i, j] = open[static_cast<unsigned>(--waiting)];
        if (j - i < 2) continue;
        const int k = apex[static_cast<unsigned>(i)][static_cast<unsigned>(j)];
        draw(loop[static_cast<unsigned>(i)], loop[static_cast<unsigned>(k)], loop[static_cast<unsigned>(j)]);
        open[static_cast<unsigned>(waiting++)] = {i, k};
        open[static_cast<unsigned>(waiting++)] = {k, j};
    }
}

template <class AnyCase>
constexpr AnyCase derive_case(unsigned corners, unsigned joined, FaceDiagonals rule) {
    const Loops loops = trace(corners, joined);
    AnyCase out;
    out.loops = static_cast<std::uint8_t>(loops.count);
    for (unsigned n = 0; n < static_cast<unsigned>(loops.count); ++n)
        triangulate(loops.edges[n], loops.lengths[n], rule, out);
    return out;
}

// Deposits the low bits of `packed` at the set bits of `mask` (the processor's pdep, at compile time).
constexpr unsigned spread(unsigned packed, unsigned mask) {
    unsigned out = 0;
    for (; mask != 0; mask &= mask - 1, packed >>= 1) {
        if (packed & 1) out |= mask & (0u - mask);
    }
    return out;
}

// The faces with alternating corners, a bit each.
constexpr unsigned alternating_faces(unsigned corners) {
    unsigned faces = 0;
    for (int face = 0; face < 6; ++face) {
        if (cube::alternates(corners, face)) faces |= 1u << face;
    }
    return faces;
}

template <class AnyCase>
constexpr TableOf<AnyCase> derive(FaceDiagonals rule) {
    TableOf<AnyCase> table;
    unsigned filled = 0;
    for (unsigned corners = 0; corners < 256; ++corners) {
        const unsigned ambiguous = alternating_faces(corners);
        table.corners[corners] = {static_cast<std::uint16_t>(filled), static_cast<std::uint8_t>(ambiguous)};
        for (unsigned packed = 0; packed < 1u << std::popcount(ambiguous); ++packed) {
            table.cases[filled++] = derive_case<AnyCase>(corners, spread(packed, ambiguous), rule);
        }
    }
    if (filled != kCases) throw "the case table has another size than expected";
    return table;
}

}  // namespace isocore::cell_loops::derivation
