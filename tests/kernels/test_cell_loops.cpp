// The case table of marching cubes, proved over all 256 sign cases and all decisions of their ambiguous faces.
#include <array>
#include <map>
#include <set>
#include <utility>

#include "check.hpp"
#include "tables/cell_loops.hpp"
#include "tables/derive_loops.hpp"

namespace {

using namespace isocore;
using namespace isocore::cell_loops;
using Directed = std::pair<int, int>;

// Calls visit(corners, joined faces, case) for all 656.
template <class Visit>
void for_each_case(const Visit& visit) {
    for (unsigned corners = 0; corners < 256; ++corners) {
        const Corners& entry = kTable.corners[corners];
        const unsigned decisions = 1u << std::popcount(static_cast<unsigned>(entry.ambiguous));
        for (unsigned packed = 0; packed < decisions; ++packed) {
            visit(corners, derivation::spread(packed, entry.ambiguous), kTable.cases[entry.first + packed]);
        }
    }
}

std::multiset<Directed> sides(const Case& drawn) {
    std::multiset<Directed> all;
    for (unsigned t = 0; t < drawn.triangles; ++t) {
        for (unsigned n = 0; n < 3; ++n) all.insert({drawn.edges[3 * t + n], drawn.edges[3 * t + (n + 1) % 3]});
    }
    return all;
}

// The sides of triangles that have no partner: what the case draws on the cube's faces.
std::set<Directed> rim(const Case& drawn) {
    const auto all = sides(drawn);
    std::set<Directed> open;
    for (const auto& [a, b] : all) {
        if (all.count({b, a}) == 0) open.insert({a, b});
    }
    return open;
}

bool crossed(unsigned corners, int edge) {
    return (corners >> cube::low_corner(edge) & 1) != (corners >> cube::high_corner(edge) & 1);
}

void every_crossed_edge_is_used_and_no_other() {
    for_each_case([](unsigned corners, unsigned, const Case& drawn) {
        std::set<int> used(drawn.edges.begin(), drawn.edges.begin() + 3 * drawn.triangles);
        for (int edge = 0; edge < 12; ++edge) CHECK(crossed(corners, edge) == (used.count(edge) == 1));
    });
}

void a_case_is_a_manifold_with_the_counted_loops() {
    for_each_case([](unsigned corners, unsigned, const Case& drawn) {
        const auto all = sides(drawn);
        for (const Directed& side : all) CHECK(all.count(side) == 1);
        int crossings = 0;
        for (int edge = 0; edge < 12; ++edge) crossings += crossed(corners, edge);
        CHECK(drawn.triangles == crossings - 2 * drawn.loops);
        std::map<int, int> next;
        for (const auto& [a, b] : rim(drawn)) CHECK(next.emplace(a, b).second);
        CHECK(static_cast<int>(next.size()) == crossings);
    });
}

std::set<Directed> on_face(const std::set<Directed>& segments, int face) {
    std::set<Directed> drawn;
    for (const auto& [a, b] : segments) {
        if (cube::edge_on_face(a, face) && cube::edge_on_face(b, face)) drawn.insert({a, b});
    }
    return drawn;
}

// The same edge seen from the cube across the face.
int across(int edge, int face) {
    const int step = 1 << (face / 2);
    return cube::edge_between(cube::low_corner(edge) ^ step, cube::high_corner(edge) ^ step);
}

void a_face_is_drawn_by_its_own_corners_and_the_other_way_round_from_across() {
    for (int face = 0; face < 6; face += 2) {
        std::map<std::pair<unsigned, unsigned>, std::set<Directed>> by_face_corners;
        const auto key = [&](unsigned corners, unsigned joined, int f) {
            unsigned signs = 0;
            for (int c : cube::face_ring(f)) signs |= (corners >> c & 1) << (c & ~(1 << (f / 2)));
            return std::pair{signs, joined >> f & 1};
        };
        for_each_case([&](unsigned corners, unsigned joined, const Case& drawn) {
            const auto [found, is_new] = by_face_corners.emplace(key(corners, joined, face), on_face(rim(drawn), face));
            CHECK(is_new || found->second == on_face(rim(drawn), face));
        });
        for_each_case([&](unsigned corners, unsigned joined, const Case& drawn) {
            std::set<Directed> seen_from_across;
            for (const auto& [a, b] : on_face(rim(drawn), face + 1))
                seen_from_across.insert({across(b, face + 1), across(a, face + 1)});
            CHECK(by_face_corners.at(key(corners, joined, face + 1)) == seen_from_across);
        });
    }
}

// Four triangles share an edge only if both cells of a face draw the same diagonal in it.
void no_diagonal_lies_in_a_face_on_both_sides() {
    for (int face = 0; face < 6; face += 2) {
        std::set<Directed> above, below;
        for_each_case([&](unsigned, unsigned, const Case& drawn) {
            const auto open = rim(drawn);
            for (const auto& [a, b] : sides(drawn)) {
                if (open.count({a, b}) || open.count({b, a})) continue;
                if (cube::shared_face(a, b) == face) above.insert({a, b});
                if (cube::shared_face(a, b) == face + 1) below.insert({across(a, face + 1), across(b, face + 1)});
            }
        });
        CHECK(!above.empty() && !below.empty());
        for (const Directed& diagonal : above) CHECK(below.count(diagonal) == 0);
    }
}

// In a face with four crossings two diagonals cross if they join both pairs of parallel edges, whoever draws them.
void no_two_diagonals_of_a_face_cross() {
    for (int face = 0; face < 6; face += 2) {
        std::array<std::set<int>, 2> axes;  // of the parallel edges that are joined, from above and from below
        for_each_case([&](unsigned, unsigned, const Case& drawn) {
            const auto open = rim(drawn);
            std::array<std::set<int>, 2> here;
            for (const auto& [a, b] : sides(drawn)) {
                if (open.count({a, b}) || open.count({b, a}) || a / 4 != b / 4) continue;
                for (const int side : {0, 1}) {
                    if (cube::shared_face(a, b) == face + side) here[static_cast<std::size_t>(side)].insert(a / 4);
                }
            }
            for (std::size_t side = 0; side < 2; ++side) {
                CHECK(here[side].size() < 2);
                axes[side].insert(here[side].begin(), here[side].end());
            }
        });
        for (const int axis : axes[0]) {
            for (const int other : axes[1]) CHECK(axis == other);
        }
    }
}

void a_single_inside_corner_is_cut_off_with_its_outside_in_front() {
    const Case& drawn = kTable.cases[kTable.corners[1].first];
    CHECK(drawn.triangles == 1);
    const std::set<Directed> expected{{0, 4}, {4, 8}, {8, 0}};  // x, y, z: counter-clockwise seen from (1, 1, 1)
    CHECK(rim(drawn) == expected);
}

}  // namespace

void test_cell_loops() {
    every_crossed_edge_is_used_and_no_other();
    a_case_is_a_manifold_with_the_counted_loops();
    a_face_is_drawn_by_its_own_corners_and_the_other_way_round_from_across();
    no_diagonal_lies_in_a_face_on_both_sides();
    no_two_diagonals_of_a_face_cross();
    a_single_inside_corner_is_cut_off_with_its_outside_in_front();
}
