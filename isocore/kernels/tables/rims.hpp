// rims.hpp - What the surface draws on a box of cells that it cuts in one disk. Tables are indexed by the box's eight
// corner signs, bit c for corner c; corners, edges and faces are numbered as in cube.hpp. Derived at compile time,
// once, in rims.cpp.
//
// Example: only corner 0 is inside, so corner signs are 1. Edges 0, 4 and 8, which meet in it, are crossed; the box is
// a disk. Its rim has length 3: edges 0, 4, 8 and faces 4, 0, 2 between them, so it goes from edge 0 across face 4 (low
// z) to edge 4, across face 0 (low x) to edge 8, and across face 2 (low y) back. Its stops are 0 to 5: edge 0, face 4,
// edge 4, face 0, edge 8, face 2.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace isocore::climbing {

// What a simple box holds: no crossing, one loop without an ambiguous face, or anything else.
enum class Content : std::uint8_t { nothing, disk, other };

extern const std::array<Content, 256> kContents;

// The crossed edges of a box, a bit each.
extern const std::array<std::uint16_t, 256> kCrossed;

// Where an edge of a box lies, in terms of the box's ends, which are numbered: low x 0, high x 1, low y 2, high y 3,
// low z 4, high z 5 (as faces are).
struct Side {
    std::uint8_t axis;                  // the one along which it runs
    std::array<std::uint8_t, 2> ends;   // those at which it lies along the other two axes, ascending
    std::array<std::uint8_t, 3> start;  // those at which its lower corner lies along x, y and z
};
extern const std::array<Side, 12> kSides;

// The loop that the surface draws on a disk box: its crossed edges in order, and the face between each and the next,
// counter-clockwise seen from outside the surface. Past its length the first edge is repeated. Empty for other boxes.
struct Rim {
    std::uint8_t length = 0;
    std::array<std::uint8_t, 6> edges{}, faces{};
};

extern const std::array<Rim, 256> kRims;

// A Rim for vector instructions, a lane for each of its edges. Lanes past its length repeat the first edge.
inline constexpr std::size_t kRimWidth = 8;
struct RimLanes {
    using LanePerEdge = std::array<float, kRimWidth>;
    LanePerEdge axes{}, face_axes{};    // the axis of the edge, and that of the face between it and the next edge
    std::array<LanePerEdge, 3> high{};  // by axis: 1 if the edge's lower corner is at the box's high end, else 0
};
extern const std::array<RimLanes, 256> kRimLanes;

// The stops of a rim are its edges (even numbers) and the faces between them (odd numbers), in its order. By part of a
// box: entry e is the stop of edge e, entry 12 + f that of face f; they are 0 for parts that the rim does not visit.
// Entry kRimLength is the rim's length.
inline constexpr std::size_t kRimLength = 18;
using LoopStops = std::array<std::uint8_t, kRimLength + 1>;
extern const std::array<LoopStops, 256> kStops;

// The entry of LoopStops for a crossing by the faces of the box that it lies on, a bit each: that of the face if it is
// one, that of the edge that the faces share if there are two.
extern const std::array<std::uint8_t, 64> kPartOfSurface;

}  // namespace isocore::climbing
