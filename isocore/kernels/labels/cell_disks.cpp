// cell_disks.cpp - H.-C. Hege, M. Seebass, D. Stalling, M. Zoeckler, "A Generalized Marching Cubes Algorithm Based on
// Non-Binary Classifications", ZIB SC-97-05, 1997; Z. Wu, J. M. Sullivan, "Multiple material marching cubes algorithm",
// Int. J. Numer. Meth. Engng 58, 2003. Our decisions are those of README.md: lines on faces, their connected parts,
// and for each part a polygon cut inside the cell or a cone to the cell's middle.
#include "labels/cell_disks.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <optional>

#include "common/cube.hpp"

namespace isocore::labels {
namespace {

using Place = std::uint8_t;

// A line on a face between two places. The corner `left` has the label on its left, seen from outside the cell.
struct Line {
    Place start, end;
    std::uint8_t left, right;

    Line reversed() const { return {end, start, right, left}; }
};

// The corners of a face in ring order, and the edges between each and its next.
struct Ring {
    std::array<std::uint8_t, 4> corner;
    std::array<Place, 4> edge;

    explicit Ring(int face) {
        const auto ring = cube::face_ring(face);
        for (std::size_t n = 0; n < 4; ++n) {
            corner[n] = static_cast<std::uint8_t>(ring[n]);
            edge[n] = static_cast<Place>(cube::edge_between(ring[n], ring[(n + 1) % 4]));
        }
    }
};

// Which two opposite corners of a face with four crossings stay joined, 0 (and 2) or 1 (and 3); nothing if the four
// labels meet in its middle. Of two labels that both alternate, the one of higher rank stays joined.
std::optional<std::size_t> joined_corner(const CornerRanks& ranks, const Ring& ring) {
    const auto rank = [&](std::size_t n) { return ranks[ring.corner[n]]; };
    const bool even = rank(0) == rank(2), odd = rank(1) == rank(3);
    if (!even && !odd) return std::nullopt;
    return even && (!odd || rank(0) > rank(1)) ? 0 : 1;
}

// The lines of one face. A line that leaves edge n inwards has corner n on its left and corner n + 1 on its right.
void add_face_lines(const CornerRanks& ranks, int face, std::vector<Line>& lines) {
    const Ring ring(face);
    std::array<std::size_t, 4> crossed{};
    std::size_t count = 0;
    for (std::size_t n = 0; n < 4; ++n) {
        if (ranks[ring.corner[n]] != ranks[ring.corner[(n + 1) % 4]]) crossed[count++] = n;
    }
    const auto leave = [&](std::size_t n, Place to) {
        lines.push_back({ring.edge[n], to, ring.corner[n], ring.corner[(n + 1) % 4]});
    };
    if (count == 2) {
        leave(crossed[0], ring.edge[crossed[1]]);
        return;
    }
    const auto joined = count == 4 ? joined_corner(ranks, ring) : std::nullopt;
    if (joined) {
        for (const std::size_t cut : {1 - *joined, 3 - *joined}) leave((cut + 3) % 4, ring.edge[cut]);
        return;
    }
    for (std::size_t n = 0; n < count; ++n) leave(crossed[n], static_cast<Place>(kFirstFace + face));
}

// The connected parts of the lines, in the order of their first lines.
std::vector<std::vector<Line>> connected_parts(std::vector<Line> lines) {
    std::vector<std::vector<Line>> parts;
    while (!lines.empty()) {
        std::array<bool, kMiddle> reached{};
        reached[lines.front().start] = true;
        std::vector<Line>& part = parts.emplace_back();
        for (bool grows = true; grows;) {
            const auto touches = [&](const Line& line) { return reached[line.start] || reached[line.end]; };
            const auto rest = std::stable_partition(lines.begin(), lines.end(), touches);
            grows = rest != lines.begin();
            for (auto line = lines.begin(); line != rest; ++line) reached[line->start] = reached[line->end] = true;
            part.insert(part.end(), lines.begin(), rest);
            lines.erase(lines.begin(), rest);
        }
    }
    return parts;
}

bool has_face_middle(const std::vector<Line>& part) {
    return std::any_of(part.begin(), part.end(), [](const Line& line) { return line.end >= kFirstFace; });
}

// The lines of a part without a face's middle, one after the other: a loop.
std::vector<Line> as_loop(std::vector<Line> part) {
    for (std::size_t n = 0; n + 1 < part.size(); ++n) {
        for (std::size_t m = n + 1; m < part.size(); ++m) {
            if (part[m].end == part[n].end) part[m] = part[m].reversed();
            if (part[m].start == part[n].end) {
                std::swap(part[n + 1], part[m]);
                break;
            }
        }
    }
    return part;
}

// A place in the doubled grid, in which the cell spans 0 to 2.
std::array<int, 3> doubled(Place place) {
    std::array<int, 3> at{1, 1, 1};
    if (place < kFirstFace) {
        const int corner = cube::low_corner(place);
        for (int axis = 0; axis < 3; ++axis) {
            if (axis != place / 4) at[static_cast<std::size_t>(axis)] = 2 * (corner >> axis & 1);
        }
    } else if (place < kMiddle) {
        const auto face = static_cast<std::size_t>(place - kFirstFace);
        at[face / 2] = 2 * static_cast<int>(face % 2);
    }
    return at;
}

// Four times the squared area of a triangle in the doubled grid.
int squared_area(Place a, Place b, Place c) {
    const auto p = doubled(a), q = doubled(b), r = doubled(c);
    int sum = 0;
    for (std::size_t x = 0; x < 3; ++x) {
        const std::size_t y = (x + 1) % 3, z = (x + 2) % 3;
        const int part = (q[y] - p[y]) * (r[z] - p[z]) - (q[z] - p[z]) * (r[y] - p[y]);
        sum += part * part;
    }
    return sum;
}

using Polygon = std::vector<Place>;
using Cut = std::vector<std::array<Place, 3>>;

// May the polygon's corners a and b be joined? Sides are; a diagonal must not lie in a face of the cell.
bool may_join(const Polygon& polygon, std::size_t a, std::size_t b) {
    const bool side = b == a + 1 || (a == 0 && b + 1 == polygon.size());
    return side || cube::shared_face(polygon[a], polygon[b]) < 0;
}

struct Cost {
    int worst = 0, sum = 0;
    auto operator<=>(const Cost&) const = default;
};

// The best way to cut the corners `first` to `last` of a polygon, which may be joined, into triangles: the largest is
// as small as it can be, then their sum. Returns nothing if there is none.
std::optional<Cost> best_cut(const Polygon& polygon, std::size_t first, std::size_t last, Cut& cut) {
    if (last - first < 2) return Cost{};
    std::optional<Cost> best;
    Cut best_triangles;
    for (std::size_t apex = first + 1; apex < last; ++apex) {
        if (!may_join(polygon, first, apex) || !may_join(polygon, apex, last)) continue;
        Cut triangles;
        const auto left = best_cut(polygon, first, apex, triangles), right = best_cut(polygon, apex, last, triangles);
        if (!left || !right) continue;
        const int area = squared_area(polygon[first], polygon[apex], polygon[last]);
        const Cost cost{std::max({left->worst, right->worst, area}), left->sum + right->sum + area};
        if (best && *best <= cost) continue;
        best = cost;
        triangles.push_back({polygon[first], polygon[apex], polygon[last]});
        best_triangles = triangles;
    }
    if (best) cut.insert(cut.end(), best_triangles.begin(), best_triangles.end());
    return best;
}

void add_cone(const std::vector<Line>& part, CellDisks& disks) {
    for (const Line& line : part) {
        disks.triangles.push_back({{line.start, line.end, kMiddle}, line.right, line.left});
        if (line.end >= kFirstFace)
            disks.faces = static_cast<std::uint8_t>(disks.faces | 1u << (line.end - kFirstFace));
    }
    disks.several_cones = disks.middle;
    disks.middle = true;
}

void add_polygon(const std::vector<Line>& loop, CellDisks& disks) {
    Polygon polygon;
    for (const Line& line : loop) polygon.push_back(line.start);
    Cut cut;
    best_cut(polygon, 0, polygon.size() - 1, cut);
    for (const auto& places : cut) disks.triangles.push_back({places, loop.front().right, loop.front().left});
}

}  // namespace

std::uint32_t disks_key(const CornerRanks& ranks) {
    std::uint32_t key = 0, labels = 0;
    std::array<std::uint32_t, 8> seen{};
    for (std::size_t n = 0; n < 8; ++n) {
        std::uint32_t number = 0;
        while (number < labels && seen[number] != ranks[n]) ++number;
        if (number == labels) seen[labels++] = ranks[n];
        key |= number << 3 * n;
    }
    for (int face = 0; face < 6; ++face) {
        const auto ring = cube::face_ring(face);
        const auto rank = [&](std::size_t n) { return ranks[static_cast<std::size_t>(ring[n])]; };
        const bool alternates = rank(0) == rank(2) && rank(1) == rank(3);
        key |= static_cast<std::uint32_t>(alternates && rank(0) > rank(1)) << (24 + face);
    }
    return key;
}

CellDisks derive_disks(const CornerRanks& ranks) {
    std::vector<Line> lines;
    for (int face = 0; face < 6; ++face) add_face_lines(ranks, face, lines);
    const auto parts = connected_parts(std::move(lines));
    // Each of two hexagons in one cell can only be cut through the cell's middle, so their disks would cross.
    const bool two_hexagons = parts.size() == 2 && parts[0].size() == 6 && parts[1].size() == 6 &&
                              !has_face_middle(parts[0]) && !has_face_middle(parts[1]);
    CellDisks disks;
    for (const auto& part : parts) {
        if (two_hexagons || has_face_middle(part)) {
            add_cone(part, disks);
        } else {
            add_polygon(as_loop(part), disks);
        }
    }
    return disks;
}

}  // namespace isocore::labels
