// edge.hpp - A grid edge of a block.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "climbing/high_rice.hpp"

namespace isocore::climbing {

// In samples from the block's origin.
using Place = std::array<int, 3>;

// A grid edge: its axis and its lower sample, a byte each. In one word, as whole words are copied faster than parts.
class Edge {
  public:
    constexpr Edge() = default;
    explicit constexpr Edge(std::uint32_t word) : word_(word) {}
    static constexpr Edge along_x(unsigned i, unsigned j, unsigned k) { return Edge(i | j << 8 | k << 16); }
    constexpr Edge of_axis(int axis) const { return Edge(word_ | static_cast<std::uint32_t>(axis) << 24); }

    constexpr std::uint32_t word() const { return word_; }
    unsigned axis() const { return word_ >> 24; }
    int at(std::size_t a) const { return static_cast<int>(word_ >> 8 * a & 255); }
    Place at() const { return {at(0), at(1), at(2)}; }

    // The ends of a box, to be compared with.
    class Ends {
      public:
        Ends() = default;
        explicit Ends(const HighRice& box) : low_(word(box.low)), high_(word(box.high)) {}

      private:
        friend class Edge;
        static std::uint32_t word(const std::array<std::uint8_t, 3>& end) {
            return end[0] | std::uint32_t{end[1]} << 8 | std::uint32_t{end[2]} << 16;
        }
        std::uint32_t low_, high_;
    };
    // The faces of a box that it lies on, a bit each.
    unsigned faces(const Ends& box) const {
        const auto equal = [&](std::uint32_t end) {  // a bit above each byte, none of which exceeds 127
            return ~(((word_ ^ end) & 0x7f7f7f) + 0x7f7f7f) & 0x808080;
        };
        const std::uint32_t pairs = equal(box.low_) >> 7 | equal(box.high_) >> 6;
        return (pairs | pairs >> 6 | pairs >> 12) & 63 & ~(3u << 2 * axis());
    }

  private:
    std::uint32_t word_ = 0;
};

}  // namespace isocore::climbing
