// piece.hpp - A piece is what halving a block leads to: the block itself, its halves, their halves, down to single
// cells. All its lengths are powers of two; it may reach past the volume's end. It takes one word:
//
//     | depth: 51..54 | axes: 48..50 | lengths z y x: 40..47 32..39 24..31 | lows z y x: 16..23 8..15 0..7 |
//
// low: its first sample along an axis, from the block's origin; length: its cells along it; axes: bit a is set if it
// can be halved along axis a, so if it is longer than one cell; depth: how often it can be halved in all.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "climbing/high_rice.hpp"

namespace isocore::climbing {

class Piece {
  public:
    Piece() = default;
    static Piece block(int size) {
        const auto length = static_cast<std::uint64_t>(size),
                   depth = static_cast<std::uint64_t>(std::countr_zero(length));
        return Piece((length | length << 8 | length << 16) << kLengths | std::uint64_t{size > 1 ? 7u : 0u} << kAxes |
                     3 * depth << kDepth);
    }

    int low(unsigned axis) const { return static_cast<int>(word_ >> 8 * axis & 255); }
    unsigned axes() const { return word_ >> kAxes & 7; }
    std::uint64_t depth() const { return word_ >> kDepth; }  // 0 for a single cell

    // Its halves along an axis along which it can be halved. Block 4 along x, from low 0 0 0, lengths 4 4 4, axes x y
    // z, depth 6:  lower = low 0 0 0, lengths 2 4 4, axes x y z, depth 5;  upper = the same from low 2 0 0. That lower
    // half along x again:  lower = low 0 0 0, lengths 1 4 4, axes y z, depth 4;  upper from low 1 0 0.
    struct Halves;
    Halves halves(unsigned axis) const;

    // The piece without what is past the end of the volume; cells: the block's along each axis before that end.
    HighRice within(const std::array<int, 3>& cells) const {
        const std::uint64_t highs = word_ + (word_ >> kLengths);  // low + length, in the lowest three bytes
        HighRice box;
        for (unsigned a = 0; a < 3; ++a) {
            box.low[a] = static_cast<std::uint8_t>(std::min(low(a), cells[a]));
            box.high[a] = static_cast<std::uint8_t>(std::min(static_cast<int>(highs >> 8 * a & 255), cells[a]));
        }
        return box;
    }

  private:
    static constexpr unsigned kLengths = 24, kAxes = 48, kDepth = 51;  // first bits
    explicit Piece(std::uint64_t word) : word_(word) {}

    std::uint64_t word_;
};

struct Piece::Halves {
    Piece lower, upper;
};

inline Piece::Halves Piece::halves(unsigned axis) const {
    const unsigned byte = 8 * axis;
    const std::uint64_t half = (word_ >> (kLengths + byte) & 255) / 2,
                        is_one_cell = half & 1;  // of the powers of two only 1 is odd
    // The lower half has a length that is `half` less, one halving less ahead, and perhaps one axis less. The upper
    // half is the same, `half` further on.
    const std::uint64_t lower =
        word_ - (half << (kLengths + byte)) - (is_one_cell << (kAxes + axis)) - (std::uint64_t{1} << kDepth);
    return {Piece(lower), Piece(lower + (half << byte))};
}

}  // namespace isocore::climbing
