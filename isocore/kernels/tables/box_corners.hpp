// box_corners.hpp - What the corners of many boxes show, a bit per box: the bit-sliced form of kContents (rims.hpp).
// rims.cpp proves at compile time that both agree.
#pragma once

#include <array>

#include "common/inlined.hpp"

namespace isocore::climbing {

// Bit n of every word belongs to the n-th box. Bit n of c[corner] is the sign of that corner, numbered as in cube.hpp;
// crossed: its corners have different signs; disk: they show one loop and no ambiguous face.
template <class Word>
struct BoxCorners {
    Word crossed, disk;

    ISOCORE_INLINED constexpr explicit BoxCorners(const std::array<Word, 8>& c) {
        // By edge: is it crossed?
        const Word x0 = c[0] ^ c[1], x1 = c[2] ^ c[3], x2 = c[4] ^ c[5], x3 = c[6] ^ c[7];
        const Word y0 = c[0] ^ c[2], y1 = c[1] ^ c[3], y2 = c[4] ^ c[6], y3 = c[5] ^ c[7];
        const Word z0 = c[0] ^ c[4], z1 = c[1] ^ c[5], z2 = c[2] ^ c[6], z3 = c[3] ^ c[7];
        crossed = x0 | x1 | x2 | x3 | y0 | y1 | y2 | y3 | z0 | z1 | z2 | z3;
        // A face is ambiguous if three of its edges are crossed (then the fourth is too).
        const Word ambiguous =
            (x0 & x1 & y1) | (x2 & x3 & y3) | (x0 & x2 & z1) | (x1 & x3 & z3) | (y0 & y2 & z2) | (y1 & y3 & z3);
        // A crossed box without an ambiguous face has two loops iff each corner has the sign of the one opposite to it.
        const Word mirrored = ~((c[0] ^ c[7]) | (c[1] ^ c[6]) | (c[2] ^ c[5]) | (c[3] ^ c[4]));
        disk = crossed & ~ambiguous & ~mirrored;
    }
};

}  // namespace isocore::climbing
