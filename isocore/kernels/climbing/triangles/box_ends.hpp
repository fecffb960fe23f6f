// box_ends.hpp - The two ends of a highrice, each packed as an Edge is packed, to tell at once which of the box's faces
// an edge lies on.
#pragma once

#include <array>
#include <cstdint>

#include "climbing/high_rice.hpp"
#include "samples/edge.hpp"

namespace isocore::climbing {

class BoxEnds {
  public:
    BoxEnds() = default;
    explicit BoxEnds(const HighRice& box) : low_(packed(box.low)), high_(packed(box.high)) {}

    // The faces of the box that a grid edge of the box lies on: bit 2 a for the low face across axis a, bit 2 a + 1 for
    // the high one. An edge along axis a lies on no face across a.
    unsigned faces(const Edge& edge) const {
        // SWAR, three bytes in one word: x ^ end is 0 in the bytes that are equal, and 0 is the only byte (all are at
        // most 127) to which 127 can be added without a carry into the byte's top bit. For example, with the edge's
        // start at (4, 2, 9) and the end at (4, 6, 9), highest byte first:
        //     09 02 04 ^ 09 06 04 = 00 04 00;   + 7f 7f 7f = 7f 83 7f;   ~ and & 80 80 80 = 80 00 80
        const auto equal = [&](std::uint32_t end) { return ~(((edge.word() ^ end) & 0x7f7f7f) + 0x7f7f7f) & 0x808080; };
        // Low ends move to bits 0, 8, 16 and high ends to 1, 9, 17; then each pair moves to its place, 2 bits per axis.
        const std::uint32_t pairs = equal(low_) >> 7 | equal(high_) >> 6;
        return (pairs | pairs >> 6 | pairs >> 12) & 63 & ~(3u << 2 * edge.axis());
    }

  private:
    static std::uint32_t packed(const std::array<std::uint8_t, 3>& end) {
        return end[0] | std::uint32_t{end[1]} << 8 | std::uint32_t{end[2]} << 16;
    }
    std::uint32_t low_, high_;  // | 0: 24..31 | z: 16..23 | y: 8..15 | x: 0..7 |
};

}  // namespace isocore::climbing
