// edge.hpp - A grid edge of a block, in one word.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace isocore {

// A sample (i, j, k), counted from the block's origin.
using Place = std::array<int, 3>;

// A grid edge: its axis and its lower sample, a byte each:
//
//     | axis: 24..31 | k: 16..23 | j: 8..15 | i: 0..7 |
//
// One word, because it is copied faster than four bytes, and because places are added as words: no byte overflows.
class Edge {
  public:
    constexpr Edge() = default;
    explicit constexpr Edge(std::uint32_t word) : word_(word) {}
    // The edge along x that starts at a sample; the edge along another axis that starts at the same sample as this one;
    // and the edge along the same axis that starts i samples further along x.
    static constexpr Edge along_x(unsigned i, unsigned j, unsigned k) { return Edge(i | j << 8 | k << 16); }
    constexpr Edge of_axis(int axis) const { return Edge(word_ | static_cast<std::uint32_t>(axis) << 24); }
    constexpr Edge further_along_x(int i) const { return Edge(word_ + static_cast<std::uint32_t>(i)); }

    constexpr std::uint32_t word() const { return word_; }
    // Its axis, and its lower sample.
    unsigned axis() const { return word_ >> 24; }
    int at(std::size_t a) const { return static_cast<int>(word_ >> 8 * a & 255); }
    Place at() const { return {at(0), at(1), at(2)}; }

  private:
    std::uint32_t word_ = 0;
};

}  // namespace isocore
