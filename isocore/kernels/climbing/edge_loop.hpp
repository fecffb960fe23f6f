// edge_loop.hpp - The loop that the surface draws on a highrice, through the kept edges on its faces.
//
// A face is shared with one highrice or several; the rectangle shared with each is a padi. All its ligns are simple, so
// one iso-line crosses it, and the iso-lines of a whole face form one path from rim to rim, which no lign meets twice: so
// it runs one way along both axes, and the kept edges in the face come in the order of how far they are that way.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "climbing/box_edges.hpp"
#include "climbing/high_rice.hpp"

namespace isocore::climbing {

class EdgeLoop {
  public:
    // Finds the order of the kept edges of a disk box that turns its triangles outwards.
    void arrange(std::span<const Edge> kept, const HighRice box, unsigned corners) {
        const Rim& rim = kRims[corners];
        const auto& stops = kStops[corners];
        std::uint64_t at_stop = 0;  // how many edges lie there, four bits each
        for (std::size_t n = 0; n < kept.size(); ++n) {
            const std::uint8_t faces = faces_of(kept[n], box), stop = stops[kPartOfSurface[faces]];
            faces_[n] = faces;
            stops_[n] = stop;
            at_stop += std::uint64_t{1} << 4 * stop;
        }
        if (kept.size() > rim.length + std::size_t{1}) return order_in_faces(kept, rim.length);
        const std::uint64_t before = at_stop * 0x1111111111111110;  // sums of those below
        for (std::size_t n = 0; n < kept.size(); ++n) order_[n] = static_cast<std::uint16_t>(before >> 4 * stops_[n] & 15);
    }

    // Which edge of the loop the n-th kept one is, and the faces of the box that it lies on, a bit each.
    std::size_t place(std::size_t n) const { return order_[n]; }
    unsigned faces(std::size_t n) const { return faces_[n]; }

  private:
    static constexpr std::size_t kLongest = 6 * 2 * 32, kTogether = 8;
    static constexpr std::int32_t kStep = 1 << 16;  // more than any distance along a face

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

    static std::uint8_t faces_of(const Edge& edge, const HighRice& box) {
        unsigned faces = 0;
        for (std::size_t a = 0; a < 3; ++a) {
            faces |= static_cast<unsigned>(edge.at[a] == box.low[a]) << 2 * a | static_cast<unsigned>(edge.at[a] == box.high[a]) << (2 * a + 1);
        }
        return static_cast<std::uint8_t>(faces & ~(3u << 2 * edge.axis));
    }

    // The same where several edges may lie in one face.
    void order_in_faces(std::span<const Edge> kept, std::size_t rim_length) {
        using Halves = std::array<std::int32_t, 3>;  // a place in half steps: edges lie between samples
        const auto halves = [&](std::size_t n) {
            Halves out;
            for (std::size_t a = 0; a < 3; ++a) out[a] = 2 * kept[n].at[a] + (kept[n].axis == a);
            return out;
        };
        std::array<Halves, 7> ends{};
        for (std::size_t n = 0; n < kept.size(); ++n) {
            if (stops_[n] % 2 == 0) ends[stops_[n] / 2u] = halves(n);
        }
        ends[rim_length] = ends[0];
        for (std::size_t n = 0; n < kept.size(); ++n) {
            places_[n] = stops_[n] * kStep;
            if (stops_[n] % 2 == 0) continue;
            const Halves here = halves(n), &from = ends[stops_[n] / 2u], &to = ends[stops_[n] / 2u + 1];
            for (std::size_t a = 0; a < 3; ++a) places_[n] += (to[a] - from[a]) * (here[a] - from[a]);
        }
        std::fill_n(places_.begin() + static_cast<std::ptrdiff_t>(kept.size()), kTogether, std::numeric_limits<std::int32_t>::max());
        for (std::size_t n = 0; n < kept.size(); ++n) {
            std::uint32_t before = 0;
            for (std::size_t m = 0; m < kept.size(); m += kTogether) {
                for (std::size_t l = 0; l < kTogether; ++l) before += places_[m + l] < places_[n];
            }
            order_[n] = static_cast<std::uint16_t>(before);
        }
    }

    std::array<std::int32_t, kLongest + kTogether> places_;  // along the loop, of the kept edges
    std::array<std::uint8_t, kLongest> faces_, stops_;
    std::array<std::uint16_t, kLongest> order_;
};

}  // namespace isocore::climbing
