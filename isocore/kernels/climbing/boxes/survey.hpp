// survey.hpp - What every dyadic box of a block holds, found for all boxes at once. A box is a product of three dikes:
// its dike along x is a bit of a word (DikeBits), its dikes along y and z are the labels by which the word is found.
// For N = 4, of which nothing_, highrice_ and at_most_ are such tables:
//
//     table[y][z]      z = 1    2    3    4 ... 7        one word, a bit for each dike along x:
//     y = 1  (0..4)      [  ] [  ] [  ] [  ]...[  ]        bit     7   6   5   4   3   2   1   0
//     y = 2  (0..2)      [  ] [##] [  ] [  ]...[  ]  --->  label   7   6   5   4   3   1   2   -
//     ...                                                  cells   3   2   1   0  2-3 0-3 0-1
//     y = 7  (3..4)      [  ] [  ] [  ] [  ]...[  ]
//
// A box may become one highrice iff
//   it is simple: every lign of the closed box is crossed at most once,
//   it is a disk: its corners alone show one loop and no ambiguous face, and
//   it is a graph: no cell face in it has alternating corners, and all its ligns along some axis are crossed in the
//   same direction (README.md says why). A single cell always may.
//
// Example: a block of N = 4 whose rows along x all read 1 1 0 0 0 from sample 0 on (1 is inside). Step 1, from sample
// 1 to 2, is crossed outwards in every row, so each row's word of such steps is bit 1. OR-ed over all rows of a box it
// is still bit 1, and the dikes with that step are 5, 2 and 1. No lign is crossed twice, all crossed ones are crossed
// outwards; so for every y and z the boxes over dikes 5, 2 and 1 are highrices, those over 3, 4, 6 and 7 hold nothing,
// and price(1, 1, bit of 1) accepts the block as a whole. With rows 0 1 0 0 0 instead, steps 0 and 1 are crossed: dikes
// 2 and 1 are crossed twice and must be split, and the least price of the block's halves is that along x: dike 2 must
// be split again, dike 3 holds nothing, kSplit + kNothing; along y or z both halves must be split, 2 kSplit.
#pragma once

#include <array>
#include <cstddef>

#include "climbing/boxes/block.hpp"
#include "climbing/boxes/dike.hpp"

namespace isocore::climbing {

// Instantiated in survey.cpp for N = 1, 2, 4, 8, 16 and 32.
template <int N>
class Survey {
  public:
    using Word = typename DikeBits<N>::Word;

    // The price of a box is an estimate of how many highrices it yields, in units of half a highrice: none, one, or,
    // for a box that must be split, two and a half: it yields two at least and often more. The sums of two prices are
    // then 0 < 2 < 4 < 5 < 7 < 10, all different, and two highrices for certain are cheaper than nothing beside a box
    // that must be split, which a price of 4 for the latter would make equal.
    static constexpr int kNothing = 0, kAccepted = 2, kSplit = 5;

    // Surveys a block; afterwards price() holds. price_of_halves() holds too if with_halves.
    void take(const Block<N>& block, bool with_halves);

    // The price of the box over dikes y and z, and over the dike along x that has this bit.
    int price(Label y, Label z, int bit) const {
        return kSplit - (kSplit - kNothing) * is(nothing_[y][z], bit) - (kSplit - kAccepted) * is(highrice_[y][z], bit);
    }
    // The price of both halves of a box together, along the axis where it is least. at_most_[n] says whether it is
    // kPrices[n] or less, and is true for all n from some n on: so every step above the price is subtracted from the
    // highest price, without a branch.
    int price_of_halves(Label y, Label z, int bit) const {
        int price = 2 * kSplit;
        for (std::size_t n = kSteps; n-- > 0;) price -= kStep[n] * is(at_most_[n][y][z], bit);
        return price;
    }

  private:
    static int is(Word boxes, int bit) { return static_cast<int>(boxes >> bit & 1); }

    // All sums of two prices, ascending, and the steps between them.
    static constexpr std::size_t kSteps = 5;
    static constexpr std::array<int, kSteps + 1> kPrices{2 * kNothing,      kNothing + kAccepted, 2 * kAccepted,
                                                         kNothing + kSplit, kAccepted + kSplit,   2 * kSplit};
    static constexpr std::array<int, kSteps> kStep = [] {
        std::array<int, kSteps> steps{};
        for (std::size_t n = 0; n < kSteps; ++n) steps[n] = kPrices[n + 1] - kPrices[n];
        return steps;
    }();

    // What is marked in the rows along x of a block: see survey.cpp.
    enum Mark : std::size_t {
        x_in,
        x_out,
        y_in,
        y_out,
        z_in,
        z_out,
        alternating_xy,
        alternating_xz,
        alternating_yz,
        again_x,
        kMarks
    };
    static constexpr bool steps_along_y(std::size_t mark);
    static constexpr bool steps_along_z(std::size_t mark);

    // One word for each sample, or step, along z; and one for each dike along z. There is no dike 0, but loops over
    // dikes take in its word, so that their length 2 N is a multiple of a vector register's.
    using Line = std::array<Word, N + 1>;
    using DikeLine = std::array<Word, 2 * N>;

    void mark(const Block<N>& block);
    void mark_plane(const Block<N>& block, std::size_t j);
    void mark_corners(const Line& rows, std::size_t j);
    void mark_again_y();
    void mark_again_z(std::size_t j);
    bool has_none(std::size_t mark) const;
    void judge(Label y, const std::array<int, 3>& cells);
    void find_bad(Label y, DikeLine& bad) const;
    void find_both_ways(Label y, DikeLine& both_ways) const;
    void set_beyond(Label y, const std::array<int, 3>& cells);
    void price_halves(Label y);

    std::array<std::array<Line, 2 * N + 1>, kMarks> marks_;  // [mark][N + j], then [mark][y]
    std::array<Line, 2 * N> again_y_;                        // ligns along y that are crossed more than once: [y][k]
    std::array<DikeLine, 2 * N + 1> again_z_;                // the same along z: [N + j][z], then [y][z]
    std::array<std::array<DikeLine, 4>, N + 1> corners_{};   // [j][low or high end along x, then along z][z]
    // For each box: does nothing cross it, may it be one highrice, is the price of its halves kPrices[n] or less?
    using Boxes = std::array<DikeLine, 2 * N>;  // [y][z]
    Boxes nothing_, highrice_;
    std::array<Boxes, kSteps> at_most_;
    // In the whole block: are all ligns along some axis crossed in one direction, is no cell face alternating?
    bool one_way_, plain_;
};

}  // namespace isocore::climbing
