// edge_loop.hpp - The loop that the surface draws on a highrice, through the kept edges on its faces.
//
// A face is shared with one highrice or several; the rectangle shared with each is a padi. All its ligns are simple, so
// one iso-line crosses it, and the iso-lines of a whole face form one path from rim to rim, which no lign meets twice: so
// it runs one way along both axes, and the kept edges in the face come in the order of how far they are that way.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "climbing/box_edges.hpp"
#include "climbing/high_rice.hpp"
#include "common/lanes.hpp"

namespace isocore::climbing {

class EdgeLoop {
  public:
    // Finds the order of the kept edges of a disk box that turns its triangles outwards.
    void arrange(std::span<const Edge> kept, const HighRice& box, unsigned corners) {
        const Rim& rim = kRims[corners];
        const auto& stops = kStops[corners];
        const Edge::Ends ends(box);
        unsigned visited = 0;  // stops
        for (std::size_t n = 0; n < kept.size(); ++n) {
            const auto faces = static_cast<std::uint8_t>(kept[n].faces(ends));
            const std::uint8_t stop = stops[kPartOfSurface[faces]];
            faces_[n] = faces;
            stops_[n] = stop;
            places_[n] = kStep * static_cast<float>(stop);
            visited |= 1u << stop;
        }
        if (static_cast<std::size_t>(std::popcount(visited)) < kept.size()) go_on_in_faces(kept, rim.length);
        Numbers(std::numeric_limits<float>::max()).store(places_.data() + kept.size());
        const Numbers zero(0.0f), one(1.0f);
        for (std::size_t first = 0; first < kept.size(); first += kLanes<float>) {
            const Numbers here(places_.data() + first);
            Numbers before = zero;
            for (std::size_t n = 0; n < kept.size(); ++n) before = before + choose(Numbers(places_[n]) < here, one, zero);
            const auto each = before.each();
            for (std::size_t n = 0; n < each.size(); ++n) order_[first + n] = static_cast<std::uint16_t>(each[n]);
        }
    }

    // Which edge of the loop the n-th kept one is, and the faces of the box that it lies on, a bit each.
    std::size_t place(std::size_t n) const { return order_[n]; }
    unsigned faces(std::size_t n) const { return faces_[n]; }

  private:
    using Numbers = Lanes<float>;
    static constexpr std::size_t kLongest = 6 * 2 * 32;
    static constexpr float kStep = 1 << 16;  // more than any distance along a face

    // Stops of a loop: its rim edges and, between them, its faces. By corner signs; edges first, then faces.
    static constexpr std::array<std::array<std::uint8_t, 18>, 256> kStops = [] {
        std::array<std::array<std::uint8_t, 18>, 256> stops{};
        for (unsigned corners = 0; corners < 256; ++corners) {
            const Rim& rim = kRims[corners];
            for (std::size_t n = 0; n < rim.length; ++n) {
                stops[corners][rim.edges[n]] = static_cast<std::uint8_t>(2 * n);
                stops[corners][12u + rim.faces[n]] = static_cast<std::uint8_t>(2 * n + 1);
            }
        }
        return stops;
    }();
    // By the faces that something lies on: its number in the above.
    static constexpr std::array<std::uint8_t, 64> kPartOfSurface = [] {
        std::array<std::uint8_t, 64> parts{};
        for (std::uint8_t edge = 0; edge < 12; ++edge) parts[kFacesOfEdge[edge]] = edge;
        for (unsigned face = 0; face < 6; ++face) parts[std::size_t{1} << face] = static_cast<std::uint8_t>(12 + face);
        return parts;
    }();

    // Adds how far the edges in faces are along these.
    void go_on_in_faces(std::span<const Edge> kept, std::size_t rim_length) {
        using Halves = std::array<std::int32_t, 3>;  // a place in half steps: edges lie between samples
        const auto halves = [&](std::size_t n) {
            Halves out;
            for (std::size_t a = 0; a < 3; ++a) out[a] = 2 * kept[n].at(a) + (kept[n].axis() == a);
            return out;
        };
        std::array<Halves, 7> ends{};
        for (std::size_t n = 0; n < kept.size(); ++n) {
            if (stops_[n] % 2 == 0) ends[stops_[n] / 2u] = halves(n);
        }
        ends[rim_length] = ends[0];
        for (std::size_t n = 0; n < kept.size(); ++n) {
            const Halves here = halves(n), &from = ends[stops_[n] / 2u], &to = ends[stops_[n] / 2u + 1];
            std::int32_t along = 0;  // 0 for those on the rim
            for (std::size_t a = 0; a < 3; ++a) along += (to[a] - from[a]) * (here[a] - from[a]);
            places_[n] += static_cast<float>(along);
        }
    }

    std::array<float, kLongest + kLanes<float>> places_;  // along the loop, of the kept edges
    std::array<std::uint8_t, kLongest> faces_, stops_;
    std::array<std::uint16_t, kLongest + kLanes<float>> order_;
};

}  // namespace isocore::climbing
