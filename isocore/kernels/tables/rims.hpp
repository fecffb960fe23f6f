// rims.hpp - What the surface draws on a box of cells that it cuts in one disk, by the box's eight corner signs (corner
// numbers as in cube.hpp). Derived at compile time, once, in rims.cpp.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace isocore::climbing {

// What a simple box holds, by its eight corner signs (corner numbers as in cube.hpp).
enum class Content : std::uint8_t { nothing, disk, other };

extern const std::array<Content, 256> kContents;

// The crossed edges of a box, a bit each.
extern const std::array<std::uint16_t, 256> kCrossed;

// Where an edge of a box lies: along which axis, at which of the ends along the other two, and its start as three of
// them.
struct Side {
    std::uint8_t axis;
    std::array<std::uint8_t, 2> ends;
    std::array<std::uint8_t, 3> start;
};
extern const std::array<Side, 12> kSides;

// The loop that the surface draws on a disk box: its crossed edges in order, and the face between each and the next.
// Past its length the first edge is repeated.
struct Rim {
    std::uint8_t length = 0;
    std::array<std::uint8_t, 6> edges{}, faces{};
};

extern const std::array<Rim, 256> kRims;

// A Rim for vector instructions, a lane for each edge: its axis, whether it is at the high end along each other, and
// the axis of the face between it and the next. Lanes past the length repeat the first edge.
inline constexpr std::size_t kRimWidth = 8;
struct RimLanes {
    using Row = std::array<float, kRimWidth>;
    Row axes{}, face_axes{};
    std::array<Row, 3> high{};
};
extern const std::array<RimLanes, 256> kRimLanes;

// The stops of a loop are, by turns, its rim edges (even numbers) and the faces between them (odd ones). Entry e is the
// stop of the box's edge e, entry 12 + f that of its face f, and the last entry is the number of rim edges.
inline constexpr std::size_t kRimLength = 18;
using LoopStops = std::array<std::uint8_t, kRimLength + 1>;
extern const std::array<LoopStops, 256> kStops;

// The entry of LoopStops for something that lies on these faces of the box, a bit each: two faces share an edge.
extern const std::array<std::uint8_t, 64> kPartOfSurface;

}  // namespace isocore::climbing
