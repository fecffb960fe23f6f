// link.cpp - The slow way to read a link, which understands every vertex.
#include "surface/link.hpp"

#include <algorithm>

namespace isocore {
namespace {

constexpr std::size_t kShortLink = 32;

// Walks from the first edge to the one that starts where it ends, and so on: a single ring is back at the first edge
// after as many steps as there are edges, and not before. Searching is quadratic, but quick in a short link.
bool is_ring(const Link& link) {
    if (link.size() < 2 || link.size() > kShortLink) return false;
    std::size_t at = 0, steps = 0;
    do {
        const std::int32_t wanted = link[at].to;
        for (at = 0; at < link.size() && link[at].from != wanted;) ++at;
        ++steps;
    } while (at != 0 && at != link.size() && steps < link.size());
    return at == 0 && steps == link.size();
}

}  // namespace

// Fills the neighbours in rising order. Returns whether none of their edges has more than two triangles.
bool LinkInspector::count_edges(EdgeCounts& counts) {
    bool manifold = true;
    neighbours_.clear();
    for (std::size_t begin = 0, end = 0; begin < uses_.size(); begin = end) {
        const std::int32_t neighbour = uses_[begin].neighbour;
        std::size_t forward = 0;
        for (end = begin; end < uses_.size() && uses_[end].neighbour == neighbour; ++end) forward += uses_[end].is_from;
        const std::size_t used = end - begin;
        neighbours_.push_back(neighbour);
        counts.edges += 1;
        counts.boundary += used == 1;
        counts.nonmanifold += used > 2;
        counts.misoriented += used == 2 && forward != 1;
        manifold = manifold && used <= 2;
    }
    return manifold;
}

std::size_t LinkInspector::root_of(std::int32_t neighbour) {
    const auto place = std::lower_bound(neighbours_.begin(), neighbours_.end(), neighbour);
    auto i = static_cast<std::size_t>(place - neighbours_.begin());
    while (parents_[i] != i) i = parents_[i] = parents_[parents_[i]];
    return i;
}

bool LinkInspector::inspect(const Link& link, EdgeCounts& counts) {
    if (is_ring(link)) {
        counts.edges += link.size();
        return true;
    }
    uses_.clear();
    for (const auto& edge : link) {
        uses_.push_back({edge.from, true});
        uses_.push_back({edge.to, false});
    }
    std::sort(uses_.begin(), uses_.end(), [](Use a, Use b) { return a.neighbour < b.neighbour; });
    const bool manifold = count_edges(counts);

    // In a manifold link every neighbour has one or two edges, so that a single connected piece is a ring or a fan.
    std::size_t pieces = neighbours_.size();
    parents_.resize(pieces);
    for (std::size_t i = 0; i < pieces; ++i) parents_[i] = i;
    for (const auto& edge : link) {
        const std::size_t a = root_of(edge.from), b = root_of(edge.to);
        if (a == b) continue;
        parents_[a] = b;
        --pieces;
    }
    return manifold && pieces == 1;
}

}  // namespace isocore
