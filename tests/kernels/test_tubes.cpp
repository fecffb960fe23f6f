// The tubes of marching cubes: each of the 196 proved, and against the cases without them.
#include <array>
#include <bit>
#include <cstdint>
#include <map>
#include <random>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "check.hpp"
#include "marching_cubes/joint.hpp"
#include "marching_cubes/marching_cubes.hpp"
#include "tables/derive_loops.hpp"
#include "tables/tubes.hpp"

namespace {

using namespace isocore;
using namespace isocore::marching_cubes;
using Directed = std::pair<int, int>;

// Calls visit(corners, joined faces, case, its number) for all 656.
template <class Visit>
void for_each_case(const Visit& visit) {
    for (unsigned corners = 0; corners < 256; ++corners) {
        const cell_loops::Corners& entry = cell_loops::kTable.corners[corners];
        for (unsigned packed = 0; packed < 1u << std::popcount(unsigned{entry.ambiguous}); ++packed) {
            const std::size_t number = entry.first + packed;
            visit(corners, cell_loops::derivation::spread(packed, entry.ambiguous), cell_loops::kTable.cases[number],
                  number);
        }
    }
}

template <class AnyCase>
std::multiset<Directed> sides(const AnyCase& drawn) {
    std::multiset<Directed> all;
    for (unsigned t = 0; t < drawn.triangles; ++t) {
        for (unsigned n = 0; n < 3; ++n) all.insert({drawn.edges[3 * t + n], drawn.edges[3 * t + (n + 1) % 3]});
    }
    return all;
}

template <class AnyCase>
std::set<Directed> rim(const AnyCase& drawn) {
    const auto all = sides(drawn);
    std::set<Directed> open;
    for (const auto& [a, b] : all) {
        if (all.count({b, a}) == 0) open.insert({a, b});
    }
    return open;
}

void a_tube_has_the_rim_of_its_case_and_no_side_twice() {
    for_each_case([](unsigned, unsigned, const cell_loops::Case& flat, std::size_t number) {
        for (std::size_t n = kTubeTable.first[number]; n < kTubeTable.first[number + 1]; ++n) {
            const Tube& tube = kTubeTable.tubes[n];
            CHECK(rim(tube.drawn) == rim(flat));
            const auto all = sides(tube.drawn);
            for (const Directed& side : all) CHECK(all.count(side) == 1);
            CHECK(tube.drawn.triangles == flat.triangles + 4);
            CHECK((tube.one & tube.other) == 0);
        }
    });
}

// A diagonal as the face knows it: axis, corner signs and decision, and the two edges as on the low side.
using Diagonal = std::tuple<int, unsigned, bool, Directed>;

template <class AnyCase>
void collect(const AnyCase& drawn, unsigned corners, unsigned joined, std::array<std::set<Diagonal>, 2>& of_side) {
    const auto open = rim(drawn);
    for (const auto& [a, b] : sides(drawn)) {
        const int face = cube::shared_face(a, b), flat = ~(1 << (face / 2));
        if (face < 0 || open.count({a, b}) || open.count({b, a})) continue;
        unsigned signs = 0;
        for (int c : cube::face_ring(face)) signs |= (corners >> c & 1) << (c & flat);
        const auto low = [&](int edge) {
            return cube::edge_between(cube::low_corner(edge) & flat, cube::high_corner(edge) & flat);
        };
        of_side[static_cast<std::size_t>(face & 1)].insert(
            {face / 2, signs, (joined >> face & 1) != 0, {low(a), low(b)}});
    }
}

void no_diagonal_lies_in_a_face_on_both_sides() {
    std::array<std::set<Diagonal>, 2> disks, all;
    for_each_case([&](unsigned corners, unsigned joined, const cell_loops::Case& flat, std::size_t number) {
        collect(flat, corners, joined, disks);
        collect(flat, corners, joined, all);
        for (std::size_t n = kTubeTable.first[number]; n < kTubeTable.first[number + 1]; ++n) {
            collect(kTubeTable.tubes[n].drawn, corners, joined, all);
        }
    });
    CHECK(all[0].size() > disks[0].size() && !disks[1].empty());
    for (const Diagonal& diagonal : all[0]) CHECK(all[1].count(diagonal) == 0);
}

void opposite_corners_meet_from_three_times_the_others_on() {
    for (double value : {2.0, 3.0, 4.0}) {
        std::array<double, 8> cell;
        cell.fill(-1);
        cell[0] = cell[7] = value;
        const Joint joint = find_joint(cell, 0x81);
        CHECK(((joint.a == 0 && joint.b == 7) || (joint.a == 7 && joint.b == 0)) == (value >= 3));
    }
}

void capped_noise_with_tubes_is_closed_and_has_the_same_vertices() {
    std::mt19937 random(7);
    std::size_t tubes = 0;
    for (int n = 0; n < 60; ++n) {
        const Dims dims{2 + random() % 70, 2 + random() % 5, 2 + random() % 5};
        std::vector<std::int16_t> samples(dims[0] * dims[1] * dims[2]);
        for (auto& sample : samples) sample = static_cast<std::int16_t>(random() % 7);
        Options options{3.0, n % 2 == 1, true, false, 1};
        const auto plain = march<std::int16_t, float>({samples.data(), dims}, options);
        options.trilinear = true;
        options.threads = 2;
        const auto mesh = march<std::int16_t, float>({samples.data(), dims}, options);
        CHECK(mesh.vertices == plain.vertices && plain.tubes == 0);
        CHECK(mesh.triangles.size() == plain.triangles.size() + 12 * mesh.tubes);
        tubes += mesh.tubes;
        std::map<Directed, int> used;
        for (std::size_t t = 0; t < mesh.triangles.size(); t += 3) {
            for (std::size_t c = 0; c < 3; ++c) ++used[{mesh.triangles[t + c], mesh.triangles[t + (c + 1) % 3]}];
        }
        for (const auto& [side, count] : used) CHECK(count == 1 && used.count({side.second, side.first}) == 1);
    }
    CHECK(tubes > 100);
}

}  // namespace

void test_tubes() {
    a_tube_has_the_rim_of_its_case_and_no_side_twice();
    no_diagonal_lies_in_a_face_on_both_sides();
    opposite_corners_meet_from_three_times_the_others_on();
    capped_noise_with_tubes_is_closed_and_has_the_same_vertices();
}
