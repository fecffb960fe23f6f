// link.cpp - Two ways to read a link: a quick one that only recognises the ordinary vertex, and one that
// understands every vertex. Nearly all vertices of a real surface are ordinary.
#include "surface/link.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

namespace isocore {
namespace {

constexpr std::size_t kLongestPlainRing = 24;

struct Neighbour {
    std::int32_t vertex;
    bool is_from;  // the triangle runs from the vertex in the middle to this neighbour
};

// A union-find over the few neighbours of one vertex.
std::size_t root_of(std::vector<std::size_t>& parent, std::size_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}

}  // namespace

bool is_plain_ring(const Opposite* link, std::size_t count) {
    if (count < 2 || count > kLongestPlainRing) return false;
    std::array<Opposite, kLongestPlainRing> ring;
    std::copy_n(link, count, ring.begin());
    // Each step looks at all edges that are left, not only as far as the first that fits: two that fit mean that
    // the ring would pass one vertex twice.
    for (std::size_t i = 0; i + 1 < count; ++i) {
        const std::int32_t reached = ring[i].to;
        if (reached == ring[0].from) return false;
        std::size_t fitting = 0;
        std::size_t next = i + 1;
        for (std::size_t j = i + 1; j < count; ++j) {
            const bool fits = ring[j].from == reached;
            fitting += fits;
            next = fits ? j : next;
        }
        if (fitting != 1) return false;
        std::swap(ring[i + 1], ring[next]);
    }
    return ring[count - 1].to == ring[0].from;
}

bool inspect_link(const Opposite* link, std::size_t count, EdgeCounts& counts) {
    std::vector<Neighbour> uses;
    uses.reserve(2 * count);
    for (std::size_t i = 0; i < count; ++i) {
        uses.push_back({link[i].from, true});
        uses.push_back({link[i].to, false});
    }
    std::sort(uses.begin(), uses.end(), [](Neighbour a, Neighbour b) { return a.vertex < b.vertex; });

    bool manifold = true;
    std::vector<std::int32_t> neighbours;
    for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
        std::size_t forward = 0;
        for (end = begin; end < uses.size() && uses[end].vertex == uses[begin].vertex; ++end) forward += uses[end].is_from;
        const std::size_t used = end - begin;
        neighbours.push_back(uses[begin].vertex);
        counts.edges += 1;
        counts.boundary += used == 1;
        counts.nonmanifold += used > 2;
        counts.misoriented += used == 2 && forward != 1;
        manifold = manifold && used <= 2;
    }

    // Every neighbour has one or two link edges, so one connected piece is a ring or a fan.
    std::vector<std::size_t> parent(neighbours.size());
    for (std::size_t i = 0; i < parent.size(); ++i) parent[i] = i;
    std::size_t pieces = parent.size();
    const auto position = [&](std::int32_t vertex) {
        return static_cast<std::size_t>(std::lower_bound(neighbours.begin(), neighbours.end(), vertex) - neighbours.begin());
    };
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t a = root_of(parent, position(link[i].from));
        const std::size_t b = root_of(parent, position(link[i].to));
        if (a == b) continue;
        parent[a] = b;
        --pieces;
    }
    return manifold && pieces == 1;
}

}  // namespace isocore
