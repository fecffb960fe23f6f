// edge_loops.hpp - The loops that the surface draws on highrices, through the kept edges on their faces.
//
// A face is shared with one highrice or several; the rectangle shared with each is a padi. All its ligns are simple, so
// one iso-line crosses it, and the iso-lines of a whole face form one path from rim to rim, which no lign meets twice:
// so it runs one way along both axes, and the kept edges in the face come in the order of how far they are that way.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "climbing/high_rice.hpp"
#include "climbing/triangles/box_edges.hpp"
#include "climbing/triangles/box_ends.hpp"
#include "tables/rims.hpp"

namespace isocore::climbing {

class EdgeLoops {
  public:
    // Finds where the kept edges of disk boxes are along their loops, which turn their triangles outwards.
    void arrange(const BoxEdges& edges, const DrawnSite& site) {
        for (std::size_t n = 0; n < edges.size(); ++n) {
            const unsigned corners = site.corners(edges.box(n));
            boxes_[n] = {BoxEnds(edges.box(n)), &kStops[corners], 0};
        }
        const auto kept = edges.kept();
        for (std::size_t n = 0; n < kept.size(); ++n) {
            Box& box = boxes_[kept[n].box()];
            const auto faces = static_cast<std::uint8_t>(box.ends.faces(kept[n].edge()));
            const std::uint8_t stop = (*box.stops)[kPartOfSurface[faces]];
            faces_[n] = faces;
            stops_[n] = stop;
            places_[n] = kStep * static_cast<float>(stop);
            box.visited |= 1u << stop;
        }
        for (std::size_t n = 0; n < edges.size(); ++n) {
            const std::size_t first = edges.first_kept(n), size = edges.first_kept(n + 1) - first;
            if (static_cast<std::size_t>(std::popcount(boxes_[n].visited)) < size)
                go_on_in_faces(kept.subspan(first, size), first, (*boxes_[n].stops)[kRimLength]);
        }
    }

    // How far the n-th of all kept edges is along its loop, and the faces of its box that it lies on, a bit each.
    float place(std::size_t n) const { return places_[n]; }
    unsigned faces(std::size_t n) const { return faces_[n]; }

  private:
    static constexpr float kStep = 1 << 16;  // more than any distance along a face

    // Adds how far the edges of a box that lie in faces are along these. The first one is of that number.
    void go_on_in_faces(std::span<const BoxEdge> kept, std::size_t first, std::size_t rim_length) {
        using Halves = std::array<std::int32_t, 3>;  // a place in half steps: edges lie between samples
        const auto halves = [&](std::size_t n) {
            Halves out;
            for (std::size_t a = 0; a < 3; ++a) out[a] = 2 * kept[n].edge().at(a) + (kept[n].edge().axis() == a);
            return out;
        };
        std::array<Halves, 7> ends{};
        for (std::size_t n = 0; n < kept.size(); ++n) {
            if (stops_[first + n] % 2 == 0) ends[stops_[first + n] / 2u] = halves(n);
        }
        ends[rim_length] = ends[0];
        for (std::size_t n = 0; n < kept.size(); ++n) {
            const unsigned stop = stops_[first + n];
            const Halves here = halves(n), &from = ends[stop / 2], &to = ends[stop / 2 + 1];
            std::int32_t along = 0;  // 0 for those on the rim
            for (std::size_t a = 0; a < 3; ++a) along += (to[a] - from[a]) * (here[a] - from[a]);
            places_[first + n] += static_cast<float>(along);
        }
    }

    struct Box {
        BoxEnds ends;
        const LoopStops* stops;
        unsigned visited;  // stops
    };
    std::array<Box, BoxEdges::kMostBoxes> boxes_;
    std::array<float, BoxEdges::kMostKept> places_;
    std::array<std::uint8_t, BoxEdges::kMostKept> faces_, stops_;
};

}  // namespace isocore::climbing
