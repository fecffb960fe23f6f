#include "tables/rims.hpp"

#include <array>
#include <cstdint>

#include "common/cube.hpp"
#include "tables/box_corners.hpp"
#include "tables/derive_loops.hpp"

namespace isocore::climbing {
namespace {

// A box is no disk if its corners show more loops than one, or an ambiguous face: then they do not tell how many.
constexpr std::array<Content, 256> derive_contents() {
    std::array<Content, 256> contents{};
    for (unsigned corners = 0; corners < 256; ++corners) {
        const bool ambiguous = cell_loops::derivation::alternating_faces(corners) != 0;
        const int loops = cell_loops::derivation::trace(corners, 0).count;
        contents[corners] = loops == 0 ? Content::nothing : loops == 1 && !ambiguous ? Content::disk : Content::other;
    }
    return contents;
}
constexpr std::array<Content, 256> kDerivedContents = derive_contents();

// BoxCorners, evaluated one box at a time, agrees with the table.
static_assert([] {
    for (unsigned corners = 0; corners < 256; ++corners) {
        std::array<unsigned, 8> bits{};
        for (unsigned c = 0; c < 8; ++c) bits[c] = corners >> c & 1;
        const BoxCorners<unsigned> box(bits);
        if ((box.crossed & 1) != (kDerivedContents[corners] != Content::nothing) ||
            (box.disk & 1) != (kDerivedContents[corners] == Content::disk))
            return false;
    }
    return true;
}());

constexpr std::array<Rim, 256> derive_rims() {
    std::array<Rim, 256> rims{};
    for (unsigned corners = 0; corners < 256; ++corners) {
        if (kDerivedContents[corners] != Content::disk) continue;
        const auto loops = cell_loops::derivation::trace(corners, 0);
        Rim& rim = rims[corners];
        rim.length = static_cast<std::uint8_t>(loops.lengths[0]);
        for (unsigned n = 0; n < rim.length; ++n) {
            const int here = loops.edges[0][n], next = loops.edges[0][(n + 1) % rim.length];
            rim.edges[n] = static_cast<std::uint8_t>(here);
            rim.faces[n] = static_cast<std::uint8_t>(cube::shared_face(here, next));
        }
        for (unsigned n = rim.length; n < rim.edges.size(); ++n) rim.edges[n] = rim.edges[0];
    }
    return rims;
}
constexpr std::array<Rim, 256> kDerivedRims = derive_rims();

// By edge: the two faces that it lies on, a bit each.
constexpr std::array<std::uint8_t, 12> kFacesOfEdge = [] {
    std::array<std::uint8_t, 12> faces{};
    for (int edge = 0; edge < 12; ++edge) {
        for (int face = 0; face < 6; ++face) {
            faces[static_cast<std::size_t>(edge)] |= static_cast<std::uint8_t>(cube::edge_on_face(edge, face) << face);
        }
    }
    return faces;
}();

}  // namespace

constinit const std::array<Content, 256> kContents = kDerivedContents;

constinit const std::array<std::uint16_t, 256> kCrossed = [] {
    std::array<std::uint16_t, 256> crossed{};
    for (unsigned corners = 0; corners < 256; ++corners) {
        for (int edge = 0; edge < 12; ++edge) {
            const unsigned low = corners >> cube::low_corner(edge) & 1, high = corners >> cube::high_corner(edge) & 1;
            crossed[corners] |= static_cast<std::uint16_t>((low ^ high) << edge);
        }
    }
    return crossed;
}();

constinit const std::array<Side, 12> kSides = [] {
    std::array<Side, 12> sides{};
    for (int edge = 0; edge < 12; ++edge) {
        const auto across = cube::other_axes(edge / 4);
        Side& side = sides[static_cast<std::size_t>(edge)];
        side.axis = static_cast<std::uint8_t>(edge / 4);
        for (unsigned a = 0; a < 3; ++a)
            side.start[a] = static_cast<std::uint8_t>(2 * a + (cube::low_corner(edge) >> a & 1));
        side.ends = {side.start[static_cast<std::size_t>(across[0])], side.start[static_cast<std::size_t>(across[1])]};
    }
    return sides;
}();

constinit const std::array<Rim, 256> kRims = kDerivedRims;

constinit const std::array<RimLanes, 256> kRimLanes = [] {
    std::array<RimLanes, 256> lanes{};
    for (unsigned signs = 0; signs < 256; ++signs) {
        for (std::size_t n = 0; n < kRimWidth; ++n) {
            const Rim& rim = kDerivedRims[signs];
            const std::size_t here = n < rim.length ? n : 0;
            const int edge = rim.edges[here];
            lanes[signs].axes[n] = static_cast<float>(edge / 4);
            lanes[signs].face_axes[n] = static_cast<float>(rim.faces[here] / 2);
            for (std::size_t a = 0; a < 3; ++a)
                lanes[signs].high[a][n] = static_cast<float>(cube::low_corner(edge) >> a & 1);
        }
    }
    return lanes;
}();

constinit const std::array<LoopStops, 256> kStops = [] {
    std::array<LoopStops, 256> stops{};
    for (unsigned corners = 0; corners < 256; ++corners) {
        const Rim& rim = kDerivedRims[corners];
        for (std::size_t n = 0; n < rim.length; ++n) {
            stops[corners][rim.edges[n]] = static_cast<std::uint8_t>(2 * n);
            stops[corners][12u + rim.faces[n]] = static_cast<std::uint8_t>(2 * n + 1);
        }
        stops[corners][kRimLength] = rim.length;
    }
    return stops;
}();

constinit const std::array<std::uint8_t, 64> kPartOfSurface = [] {
    std::array<std::uint8_t, 64> parts{};
    for (std::uint8_t edge = 0; edge < 12; ++edge) parts[kFacesOfEdge[edge]] = edge;
    for (unsigned face = 0; face < 6; ++face) parts[std::size_t{1} << face] = static_cast<std::uint8_t>(12 + face);
    return parts;
}();

}  // namespace isocore::climbing
