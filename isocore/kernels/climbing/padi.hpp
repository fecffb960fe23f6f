// padi.hpp - A padi is the rectangle that two highrices share, a lign of cells thick on neither side: all its ligns are
// simple, so one iso-line crosses it. Here the iso-lines of a whole box face are walked in one go: within the face of
// a simple disk they form one staircase, and the kept edges it meets on its way are the rims of the padis.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "climbing/high_rice.hpp"
#include "climbing/site.hpp"
#include "common/cube.hpp"

namespace isocore::climbing {

// A crossed grid edge on a box: its axis, its lower sample, and the faces of the box it lies on, one bit each.
struct RimEdge {
    int axis;
    Place at;
    unsigned faces;
};

inline constexpr std::array<std::uint8_t, 12> kFacesOfEdge = [] {
    std::array<std::uint8_t, 12> faces{};
    for (int edge = 0; edge < 12; ++edge) {
        for (int face = 0; face < 6; ++face) {
            faces[static_cast<std::size_t>(edge)] |= static_cast<std::uint8_t>(cube::edge_on_face(edge, face) << face);
        }
    }
    return faces;
}();

// The one crossing on a crossed edge of a simple box, by halving.
inline RimEdge box_crossing(const Site& site, const HighRice& box, int edge) {
    const int axis = edge / 4, corner = cube::low_corner(edge);
    const auto a = static_cast<std::size_t>(axis);
    RimEdge out{axis, {}, kFacesOfEdge[static_cast<std::size_t>(edge)]};
    for (std::size_t n = 0; n < 3; ++n) out.at[n] = corner >> n & 1 ? box.high[n] : box.low[n];
    int low = box.low[a], high = box.high[a];
    if (high - low > 1) {
        const bool first = site.sign(out.at);
        while (high - low > 1) {
            out.at[a] = (low + high) / 2;
            (site.sign(out.at) == first ? low : high) = out.at[a];
        }
        out.at[a] = low;
    }
    return out;
}

// The loop of a disk box: every vertex on its surface, in the order that turns its triangles outwards.
class RimWalk {
  public:
    void loop(const Site& site, const HighRice& box, const Rim& rim, std::vector<RimEdge>& out) const {
        out.clear();
        std::array<RimEdge, 7> ends;
        for (unsigned n = 0; n < rim.length; ++n) ends[n] = box_crossing(site, box, rim.edges[n]);
        ends[rim.length] = ends[0];
        for (unsigned n = 0; n < rim.length; ++n) {
            out.push_back(ends[n]);
            const auto across = cube::other_axes(rim.faces[n] / 2);
            const int around = box.length(static_cast<std::size_t>(across[0])) + box.length(static_cast<std::size_t>(across[1]));
            if (around == 3) peek(site, box, rim.faces[n], out);
            if (around > 3) walk(site, box, rim.faces[n], ends[n], ends[n + 1], out);
        }
    }

  private:
    // The same for a face of two cells, which has one edge within.
    static void peek(const Site& site, const HighRice& box, int face, std::vector<RimEdge>& out) {
        const auto across = cube::other_axes(face / 2);
        const int axis = box.length(static_cast<std::size_t>(across[0])) == 1 ? across[0] : across[1];
        Place at{box.low[0], box.low[1], box.low[2]};
        ++at[static_cast<std::size_t>(across[0] + across[1] - axis)];
        const auto normal = static_cast<std::size_t>(face / 2);
        if (face & 1) at[normal] = box.high[normal];
        if (site.kept(axis, at)) out.push_back({axis, at, 1u << face});
    }

    // Adds the kept edges strictly between two edges on the rim of a face.
    static void walk(const Site& site, const HighRice& box, int face, const RimEdge& from, const RimEdge& to, std::vector<RimEdge>& out) {
        const auto across = cube::other_axes(face / 2);
        RimEdge here{from.axis, from.at, 1u << face};
        int step = here.at[static_cast<std::size_t>(across[0] + across[1] - here.axis)] ==
                           box.low[static_cast<std::size_t>(across[0] + across[1] - here.axis)]
                       ? 1
                       : -1;  // along the other axis of the face
        while (true) {
            const auto u = static_cast<std::size_t>(here.axis), v = static_cast<std::size_t>(across[0] + across[1] - here.axis);
            const bool first = site.sign(here.at);
            Place far = here.at;
            far[v] += step;
            const bool far_first = site.sign(far);
            ++far[u];
            const bool far_second = site.sign(far);
            if (far_first != far_second) {
                here.at[v] += step;
            } else {
                if (step < 0) --here.at[v];
                step = far_first == first ? 1 : -1;
                if (step > 0) ++here.at[u];
                here.axis = static_cast<int>(v);
            }
            if (here.axis == to.axis && here.at == to.at) return;
            if (site.kept(here.axis, here.at)) out.push_back(here);
        }
    }
};

}  // namespace isocore::climbing
