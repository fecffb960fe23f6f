// The loops of a case part the cell's boundary into groups of corners, inside and outside by turns, which form a tree.
// Two groups of one side that meet inside the cell turn the group between them into a ring around the joint, and the
// two loops of that group into the ends of a tube. Its triangles form a strip, each with a side on one loop and its
// tip on the other; a corner of the longer loop may be cut off first.
// Diagonals in faces are shared out as in derive_loops.hpp.
#include "tables/tubes.hpp"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "common/cube.hpp"
#include "tables/derive_loops.hpp"

namespace isocore::marching_cubes {
namespace {

namespace derivation = cell_loops::derivation;
using derivation::FaceDiagonals;
using derivation::kForbidden;

constexpr std::size_t at(int n) { return static_cast<std::size_t>(n); }

// For each corner the corners that the case connects it to on the cell's boundary, itself included.
constexpr std::array<unsigned, 8> groups(unsigned corners, unsigned joined) {
    std::array<unsigned, 8> group{};
    for (std::size_t c = 0; c < 8; ++c) group[c] = 1u << c;
    const auto unite = [&](int a, int b) {
        const unsigned both = group[at(a)] | group[at(b)];
        for (std::size_t c = 0; c < 8; ++c) {
            if (both >> c & 1) group[c] = both;
        }
    };
    for (int edge = 0; edge < 12; ++edge) {
        const int low = cube::low_corner(edge), high = cube::high_corner(edge);
        if ((corners >> low & 1) == (corners >> high & 1)) unite(low, high);
    }
    for (int face = 0; face < 6; ++face) {
        if (!cube::alternates(corners, face)) continue;
        const auto ring = cube::face_ring(face);
        const std::size_t n = (corners >> ring[0] & 1) == (joined >> face & 1) ? 0 : 1;
        unite(ring[n], ring[n + 2]);
    }
    return group;
}

// Slices along any axis must see the groups meet: on diagonally opposite edges, by way of a corner of each.
constexpr bool can_meet(unsigned one, unsigned other) {
    for (int axis = 0; axis < 3; ++axis) {
        const int across = 7 & ~(1 << axis);
        bool seen = false;
        for (int c = 0; c < 8; ++c) {
            seen = seen || ((one >> c & 1) && ((other >> (c ^ across) & 1) || (other >> (c ^ 7) & 1)));
        }
        if (!seen) return false;
    }
    return true;
}

constexpr int diagonal_cost(int a, int b) { return derivation::diagonal_cost(a, b, FaceDiagonals::shared_out); }

// The cheapest strip between two loops, found by trying all ways round. It starts at ahead[0] and back[start].
struct Strip {
    enum class Step : std::uint8_t { ahead, back, back_past_corner };

    std::array<int, 12> ahead{}, back{};  // the shorter loop in its direction, the longer against it
    int m, n;
    int cost = kForbidden, start = 0, length = 0;
    std::array<Step, 12> steps{}, tried{};

    constexpr Strip(const std::array<int, 12>& shorter, int m_, const std::array<int, 12>& longer, int n_)
        : ahead(shorter), m(m_), n(n_) {
        for (int j = 0; j < n; ++j) back[at(j)] = longer[at(n - 1 - j)];
        for (int first = 0; first < n; ++first) search(first, 0, 0, 0, 0);
        if (cost >= kForbidden) throw "two loops have no legal strip";
    }

    constexpr int ahead_at(int i) const { return ahead[at(i % m)]; }
    constexpr int back_at(int j) const { return back[at(j % n)]; }

    // Depth-first search, cut off where it costs more than the best strip so far. i and j are how far the strip is
    // along either loop. At least three of its steps must go along the longer loop, as with fewer a side would be used
    // twice.
    constexpr void search(int first, int i, int j, int taken, int cost_so_far) {
        if (cost_so_far >= cost) return;
        if (i == m && j == n) {
            if (taken - m < 3 || goes_round_at_once(taken)) return;
            cost = cost_so_far;
            start = first;
            length = taken;
            steps = tried;
            return;
        }
        const int bridge = cost_so_far + diagonal_cost(ahead_at(i), back_at(first + j));
        const auto go = [&](Step step, int to_i, int to_j, int cost_there) {
            tried[at(taken)] = step;
            search(first, to_i, to_j, taken + 1, cost_there);
        };
        if (i < m) go(Step::ahead, i + 1, j, bridge);
        if (j < n) go(Step::back, i, j + 1, bridge);
        if (j + 1 < n)
            go(Step::back_past_corner, i, j + 2, bridge + diagonal_cost(back_at(first + j), back_at(first + j + 2)));
    }

    // All steps along one loop in a row (as a ring): the strip would close on itself at one corner.
    constexpr bool goes_round_at_once(int taken) const {
        int changes = 0;
        for (int s = 0; s < taken; ++s)
            changes += (tried[at(s)] == Step::ahead) != (tried[at((s + 1) % taken)] == Step::ahead);
        return changes <= 2;
    }
};

template <class AnyCase>
constexpr void draw_strip(const Strip& strip, AnyCase& out) {
    const auto draw = [&](int a, int b, int c) {
        const auto place = static_cast<std::size_t>(3 * out.triangles++);
        out.edges[place] = static_cast<std::uint8_t>(a);
        out.edges[place + 1] = static_cast<std::uint8_t>(b);
        out.edges[place + 2] = static_cast<std::uint8_t>(c);
    };
    int i = 0, j = strip.start;
    for (int s = 0; s < strip.length; ++s) {
        if (strip.steps[at(s)] == Strip::Step::ahead) {
            draw(strip.ahead_at(i), strip.ahead_at(i + 1), strip.back_at(j));
            ++i;
            continue;
        }
        const int to = strip.steps[at(s)] == Strip::Step::back ? j + 1 : j + 2;
        draw(strip.back_at(to), strip.back_at(j), strip.ahead_at(i));
        if (to == j + 2) draw(strip.back_at(to), strip.back_at(j + 1), strip.back_at(j));
        j = to;
    }
}

constexpr Tube derive_tube(const derivation::Loops& loops, int a, int b, unsigned one, unsigned other) {
    Tube tube{static_cast<std::uint8_t>(one), static_cast<std::uint8_t>(other), {}};
    tube.drawn.loops = static_cast<std::uint8_t>(loops.count);
    if (loops.lengths[at(a)] > loops.lengths[at(b)]) {
        const int longer = a;
        a = b;
        b = longer;
    }
    draw_strip(Strip(loops.edges[at(a)], loops.lengths[at(a)], loops.edges[at(b)], loops.lengths[at(b)]), tube.drawn);
    for (int n = 0; n < loops.count; ++n) {
        if (n == a || n == b) continue;
        derivation::triangulate(loops.edges[at(n)], loops.lengths[at(n)], FaceDiagonals::shared_out, tube.drawn);
    }
    return tube;
}

constexpr TubeTable derive_tubes() {
    TubeTable table;
    std::size_t filled = 0, case_number = 0;
    for (unsigned corners = 0; corners < 256; ++corners) {
        const unsigned ambiguous = derivation::alternating_faces(corners);
        for (unsigned packed = 0; packed < 1u << std::popcount(ambiguous); ++packed) {
            table.first[case_number++] = static_cast<std::uint16_t>(filled);
            const unsigned joined = derivation::spread(packed, ambiguous);
            const auto loops = derivation::trace(corners, joined);
            const auto group = groups(corners, joined);
            // The groups on the inner and the outer side of a loop.
            const auto side = [&](int loop, unsigned inside) {
                const int edge = loops.edges[at(loop)][0], low = cube::low_corner(edge);
                return group[at((corners >> low & 1) == inside ? low : cube::high_corner(edge))];
            };
            for (int a = 0; a < loops.count; ++a) {
                for (int b = a + 1; b < loops.count; ++b) {
                    for (unsigned between : {0u, 1u}) {
                        const unsigned one = side(a, 1 - between), other = side(b, 1 - between);
                        if (side(a, between) != side(b, between) || !can_meet(one, other)) continue;
                        table.tubes[filled++] = derive_tube(loops, a, b, one, other);
                    }
                }
            }
        }
    }
    table.first[case_number] = static_cast<std::uint16_t>(filled);
    if (filled != kTubes) throw "the table of tubes has another size than expected";
    return table;
}

constexpr TubeTable kDerived = derive_tubes();

}  // namespace

constinit const TubeTable kTubeTable = kDerived;

}  // namespace isocore::marching_cubes
