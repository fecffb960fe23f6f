// high_rice.hpp - A highrice is a box of cells that gets its triangles in one piece, and what its corners must look
// like for that: the surface cuts a disk from it.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "common/cell_loops.hpp"
#include "common/cube.hpp"

namespace isocore::climbing {

// In samples from its block's origin; both ends belong to it.
struct HighRice {
    std::array<std::uint8_t, 3> low, high;

    int length(std::size_t axis) const { return high[axis] - low[axis]; }
    bool operator==(const HighRice&) const = default;
};

// What a simple box holds, by its eight corner signs (corner numbers as in cube.hpp).
enum class Content : std::uint8_t { nothing, disk, other };

constexpr std::array<Content, 256> derive_contents() {
    std::array<Content, 256> contents{};
    for (unsigned corners = 0; corners < 256; ++corners) {
        const auto& entry = cell_loops::kTable.corners[corners];
        const auto& drawn = cell_loops::kTable.cases[entry.first];
        const bool disk = entry.ambiguous == 0 && drawn.loops == 1;
        contents[corners] = drawn.loops == 0 ? Content::nothing : disk ? Content::disk : Content::other;
    }
    return contents;
}
inline constexpr std::array<Content, 256> kContents = derive_contents();

inline constexpr std::array<std::uint8_t, 12> kFacesOfEdge = [] {
    std::array<std::uint8_t, 12> faces{};
    for (int edge = 0; edge < 12; ++edge) {
        for (int face = 0; face < 6; ++face) {
            faces[static_cast<std::size_t>(edge)] |= static_cast<std::uint8_t>(cube::edge_on_face(edge, face) << face);
        }
    }
    return faces;
}();

// The loop that the surface draws on a disk box: its crossed edges in order, and the face between each and the next.
// Past its length the first edge is repeated.
struct Rim {
    std::uint8_t length = 0;
    std::array<std::uint8_t, 6> edges{}, faces{};
};

constexpr std::array<Rim, 256> derive_rims() {
    std::array<Rim, 256> rims{};
    for (unsigned corners = 0; corners < 256; ++corners) {
        if (kContents[corners] != Content::disk) continue;
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
inline constexpr std::array<Rim, 256> kRims = derive_rims();

}  // namespace isocore::climbing
