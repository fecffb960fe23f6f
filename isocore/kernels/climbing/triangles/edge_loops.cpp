#include "climbing/triangles/edge_loops.hpp"

#include <bit>

namespace isocore::climbing {
namespace {

constexpr float kStep = 1 << 16;  // from one stop's keys to the next one's: more than any distance along a face

// A place in half steps, as the middle of an edge lies between two samples.
using HalfSteps = std::array<std::int32_t, 3>;
HalfSteps middle(const Edge& edge) {
    HalfSteps out;
    for (std::size_t a = 0; a < 3; ++a) out[a] = 2 * edge.at(a) + (edge.axis() == a);
    return out;
}

}  // namespace

void EdgeLoops::arrange(const BoxEdges& edges, const DrawnSite& site) {
    for (std::size_t n = 0; n < edges.size(); ++n) {
        const unsigned corners = site.corners(edges.box(n));
        loops_[n] = {BoxEnds(edges.box(n)), &kStops[corners], 0};
    }
    const auto kept = edges.kept();
    for (std::size_t n = 0; n < kept.size(); ++n) {
        LoopOfBox& loop = loops_[kept[n].box()];
        const auto faces = static_cast<std::uint8_t>(loop.ends.faces(kept[n].edge()));
        const std::uint8_t stop = (*loop.stops)[kPartOfSurface[faces]];
        faces_[n] = faces;
        stops_[n] = stop;
        places_[n] = kStep * static_cast<float>(stop);
        loop.visited |= 1u << stop;
    }
    // The stops alone order a loop, unless a face has several edges. Rim stops have one each, so this is a matter of
    // counting.
    for (std::size_t n = 0; n < edges.size(); ++n) {
        const std::size_t first = edges.first_kept(n), size = edges.first_kept(n + 1) - first;
        if (static_cast<std::size_t>(std::popcount(loops_[n].visited)) < size)
            order_in_faces(kept.subspan(first, size), first, (*loops_[n].stops)[kRimLength]);
    }
}

// Adds to the keys of one box's edges their distance along the face they lie in: the dot product with the way from the
// rim edge before that face to the rim edge behind it. Edges on the rim add 0. `first` is the number of kept[0].
void EdgeLoops::order_in_faces(std::span<const BoxEdge> kept, std::size_t first, std::size_t rim_length) {
    std::array<HalfSteps, 7> rim{};  // the loop's rim edges in order, the first one once more at the end
    for (std::size_t n = 0; n < kept.size(); ++n) {
        if (stops_[first + n] % 2 == 0) rim[stops_[first + n] / 2u] = middle(kept[n].edge());
    }
    rim[rim_length] = rim[0];
    for (std::size_t n = 0; n < kept.size(); ++n) {
        const unsigned stop = stops_[first + n];
        const HalfSteps here = middle(kept[n].edge()), &from = rim[stop / 2], &to = rim[stop / 2 + 1];
        std::int32_t along = 0;
        for (std::size_t a = 0; a < 3; ++a) along += (to[a] - from[a]) * (here[a] - from[a]);
        places_[first + n] += static_cast<float>(along);
    }
}

}  // namespace isocore::climbing
