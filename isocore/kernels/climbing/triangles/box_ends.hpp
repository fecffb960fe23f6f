// box_ends.hpp - The ends of a highrice packed as an Edge is packed, to tell at once which of the box's faces an edge
// lies on.
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

    // The faces of the box that a grid edge lies on, a bit each.
    unsigned faces(const Edge& edge) const {
        // SWAR: bytes that are equal have their difference 0, and 0 is the only byte (none exceeds 127) to which 127
        // can be added without reaching the byte's top bit. So ~ leaves the top bits of equal bytes: bits 7, 15 and 23.
        const auto equal = [&](std::uint32_t end) { return ~(((edge.word() ^ end) & 0x7f7f7f) + 0x7f7f7f) & 0x808080; };
        // Low ends move to bits 0, 8, 16 and high ends to 1, 9, 17; then each pair to its place, two bits per axis.
        const std::uint32_t pairs = equal(low_) >> 7 | equal(high_) >> 6;
        return (pairs | pairs >> 6 | pairs >> 12) & 63 & ~(3u << 2 * edge.axis());
    }

  private:
    static std::uint32_t packed(const std::array<std::uint8_t, 3>& end) {
        return end[0] | std::uint32_t{end[1]} << 8 | std::uint32_t{end[2]} << 16;
    }
    std::uint32_t low_, high_;
};

}  // namespace isocore::climbing
