// survey.hpp - What every dyadic box of a block holds, found for all boxes at once: a word answers for all dikes along
// the first axis, and the loops run over the dikes of the other two. A box may become one highrice iff
//   it is simple: every lign of the closed box is crossed at most once,
//   it is a disk: its corners alone show one loop and no ambiguous face, and
//   it is a graph: no cell face in it has alternating corners, and all its ligns along some axis are crossed in the
//   same direction (README.md says why). A single cell always may.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "climbing/boxes/block.hpp"
#include "climbing/boxes/dike.hpp"
#include "climbing/high_rice.hpp"
#include "common/inlined.hpp"
#include "tables/box_corners.hpp"

namespace isocore::climbing {

template <int N>
class Survey {
  public:
    using Bits = DikeBits<N>;
    using Word = typename Bits::Word;

    // What becomes of a box, as the price of what it yields: in half boxes, and more than two boxes if it must be
    // split.
    static constexpr int kNothing = 0, kAccepted = 2, kSplit = 5;

    // further: is it to be known what the halves of boxes cost?
    void take(const Block<N>& block, bool further) {
        mark(block);
        for (Label y = 1; y < 2 * N; ++y) judge(y, block.cells);
        if (!further) return;
        for (Label y = 1; y < 2 * N; ++y) price_halves(y);
    }

    // By the labels of the dikes along y and z, and the bit of the one along x.
    int price(Label y, Label z, int bit) const {
        return kSplit - (kSplit - kNothing) * is(nothing_[y][z], bit) - (kSplit - kAccepted) * is(highrice_[y][z], bit);
    }
    // The price of both halves together, along the axis where it is least.
    int price_of_halves(Label y, Label z, int bit) const {
        int price = 2 * kSplit;
        for (std::size_t n = kSteps; n-- > 0;) price -= kStep[n] * is(at_most_[n][y][z], bit);
        return price;
    }

  private:
    static int is(Word boxes, int bit) { return static_cast<int>(boxes >> bit & 1); }

    // What two halves may cost together, but for both being split.
    static constexpr std::size_t kSteps = 5;
    static constexpr std::array<int, kSteps + 1> kPrices{2 * kNothing,      kNothing + kAccepted, 2 * kAccepted,
                                                         kNothing + kSplit, kAccepted + kSplit,   2 * kSplit};
    static constexpr std::array<int, kSteps> kStep = [] {
        std::array<int, kSteps> steps{};
        for (std::size_t n = 0; n < kSteps; ++n) steps[n] = kPrices[n + 1] - kPrices[n];
        return steps;
    }();

    // Marks of samples, or of steps from a sample to the next, by which of the two they are along y and z.
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
    static constexpr bool steps_along_y(std::size_t mark) {
        return mark == y_in || mark == y_out || mark == alternating_xy || mark == alternating_yz;
    }
    static constexpr bool steps_along_z(std::size_t mark) {
        return mark == z_in || mark == z_out || mark == alternating_xz || mark == alternating_yz;
    }

    using Line = std::array<Word, N + 1>;      // along z, by sample or step
    using DikeLine = std::array<Word, 2 * N>;  // along z, by dike

    void mark(const Block<N>& block) {
        for (std::size_t j = 0; j <= N; ++j) {
            mark_plane(block, j);
            mark_corners(block.rows[j], j);
            mark_again_z(j);
        }
        one_way_ =
            has_none(x_in) || has_none(x_out) || has_none(y_in) || has_none(y_out) || has_none(z_in) || has_none(z_out);
        plain_ = has_none(alternating_xy) && has_none(alternating_xz) && has_none(alternating_yz);
        for (std::size_t m = 0; m < kMarks; ++m) sum_up_y(marks_[m], steps_along_y(m));
        sum_up_y(again_z_, false);
        for (std::size_t k = 0; k <= N; ++k) {
            for (std::size_t y = N; y < 2 * N; ++y) again_y_[y][k] = 0;
        }
        for (std::size_t y = N - 1; y >= 1; --y) {
            for (std::size_t k = 0; k <= N; ++k) {
                const auto crossed = [&](std::size_t dike) { return marks_[y_in][dike][k] | marks_[y_out][dike][k]; };
                again_y_[y][k] = again_y_[2 * y][k] | again_y_[2 * y + 1][k] | (crossed(2 * y) & crossed(2 * y + 1));
            }
        }
    }

    // Faces between four ligns of which each of the middle two is a neighbour of both others.
    ISOCORE_INLINED static Word alternating(Word first, Word one, Word other, Word last) {
        return (first ^ one) & (first ^ other) & ~(first ^ last);
    }

    // Marks what starts in plane j of the block.
    void mark_plane(const Block<N>& block, std::size_t j) {
        const Line &here = block.rows[j], &next = block.rows[std::min<std::size_t>(j + 1, N)];
        const auto line = [&](std::size_t m) -> Line& { return marks_[m][N + j]; };
        for (std::size_t k = 0; k <= N; ++k) {
            const Word row = here[k], right = next[k], along = row >> 1;
            line(x_in)[k] = ~row & along & Bits::kUnits;
            line(x_out)[k] = row & ~along & Bits::kUnits;
            line(y_in)[k] = ~row & right;
            line(y_out)[k] = row & ~right;
            line(alternating_xy)[k] = alternating(row, right, along, right >> 1) & Bits::kUnits;
            line(again_x)[k] = Bits::crossed_again(row);
        }
        for (std::size_t k = 0; k < N; ++k) {
            const Word row = here[k], right = next[k], up = here[k + 1];
            line(z_in)[k] = ~row & up;
            line(z_out)[k] = row & ~up;
            line(alternating_xz)[k] = alternating(row, up, row >> 1, up >> 1) & Bits::kUnits;
            line(alternating_yz)[k] = alternating(row, right, up, next[k + 1]);
        }
        for (const std::size_t m : {z_in, z_out, alternating_xz, alternating_yz}) line(m)[N] = 0;
    }

    // The signs at both ends of all dikes along x and z, of the ligns in plane j.
    void mark_corners(const Line& rows, std::size_t j) {
        Line starting, ending;
        for (std::size_t k = 0; k <= N; ++k) {
            starting[k] = Bits::starting(rows[k]);
            ending[k] = Bits::ending(rows[k]);
        }
        for (Label z = 1; z < 2 * N; ++z) {
            const auto low = static_cast<std::size_t>(Dike<N>::start(z)),
                       high = static_cast<std::size_t>(Dike<N>::end(z));
            corners_[j][0][z] = starting[low];
            corners_[j][1][z] = ending[low];
            corners_[j][2][z] = starting[high];
            corners_[j][3][z] = ending[high];
        }
    }

    // Which ligns along z of plane j are crossed several times.
    void mark_again_z(std::size_t j) {
        DikeLine crossed, &again = again_z_[N + j];
        again = {};
        for (std::size_t k = 0; k < N; ++k) crossed[N + k] = marks_[z_in][N + j][k] | marks_[z_out][N + j][k];
        for (std::size_t z = N - 1; z >= 1; --z) {
            crossed[z] = crossed[2 * z] | crossed[2 * z + 1];
            again[z] = again[2 * z] | again[2 * z + 1] | (crossed[2 * z] & crossed[2 * z + 1]);
        }
    }

    bool has_none(std::size_t mark) const {
        Word found = 0;
        for (std::size_t j = 0; j <= N; ++j) {
            for (std::size_t k = 0; k <= N; ++k) found |= marks_[mark][N + j][k];
        }
        return found == 0;
    }

    // From the units along y, which come first as N + 1 samples or as N steps, to all dikes.
    template <class AnyLine>
    static void sum_up_y(std::array<AnyLine, 2 * N + 1>& lines, bool steps) {
        const auto unite = [](AnyLine& out, const AnyLine& a, const AnyLine& b) {
            for (std::size_t n = 0; n < out.size(); ++n) out[n] = a[n] | b[n];
        };
        if (!steps) {
            for (std::size_t j = 0; j < N; ++j) unite(lines[N + j], lines[N + j], lines[N + j + 1]);
        }
        for (std::size_t y = N - 1; y >= 1; --y) unite(lines[y], lines[2 * y], lines[2 * y + 1]);
    }

    // The same along z.
    static void sum_up_z(const Line& line, bool steps, DikeLine& out) {
        for (std::size_t k = 0; k < N; ++k) out[N + k] = steps ? line[k] : line[k] | line[k + 1];
        halve<N / 2>(out);
    }
    // From dikes along z to those twice as long, which there are `count` of, and so on; a template, so that loops over
    // them vectorise.
    template <std::size_t count>
    static void halve(DikeLine& line) {
        if constexpr (count > 0) {
            for (std::size_t z = 0; z < count; ++z)
                line[count + z] = line[2 * count + 2 * z] | line[2 * count + 2 * z + 1];
            halve<count / 2>(line);
        } else {
            line[0] = 0;
        }
    }

    // Answers for all boxes over dike y. Loops take in the label 0, which no dike has, to be as long as registers.
    void judge(Label y, const std::array<int, 3>& cells) {
        std::array<DikeLine, kMarks> marks;
        DikeLine again, bad;
        const auto sum_up = [&](std::size_t m) { sum_up_z(marks_[m][y], steps_along_z(m), marks[m]); };
        sum_up_z(again_y_[y], false, again);
        sum_up(again_x);
        for (std::size_t z = 0; z < 2 * N; ++z)
            bad[z] = marks[again_x][z] | Bits::over_samples(again[z] | again_z_[y][z]);
        if (!plain_) {
            for (std::size_t m = alternating_xy; m <= alternating_yz; ++m) sum_up(m);
            for (std::size_t z = 0; z < 2 * N; ++z) {
                bad[z] |= Bits::over_steps(marks[alternating_xy][z] | marks[alternating_xz][z]) |
                          Bits::over_samples(marks[alternating_yz][z]);
            }
        }
        DikeLine both_ways{};
        if (!one_way_) {
            for (std::size_t m = x_in; m <= z_out; ++m) sum_up(m);
            for (std::size_t z = 0; z < 2 * N; ++z) {
                both_ways[z] = Bits::over_steps(marks[x_in][z]) & Bits::over_steps(marks[x_out][z]) &
                               Bits::over_samples(marks[y_in][z]) & Bits::over_samples(marks[y_out][z]) &
                               Bits::over_samples(marks[z_in][z]) & Bits::over_samples(marks[z_out][z]);
            }
        }
        const auto &low = corners_[static_cast<std::size_t>(Dike<N>::start(y))],
                   &high = corners_[static_cast<std::size_t>(Dike<N>::end(y))];
        for (std::size_t z = 0; z < 2 * N; ++z) {
            const BoxCorners<Word> box(
                {low[0][z], low[1][z], high[0][z], high[1][z], low[2][z], low[3][z], high[2][z], high[3][z]});
            nothing_[y][z] = ~(box.crossed | bad[z]);
            highrice_[y][z] = box.disk & ~bad[z] & ~both_ways[z];
        }
        if (Dike<N>::is_unit(y)) {
            for (std::size_t z = N; z < 2 * N; ++z)
                highrice_[y][z] |= ~nothing_[y][z] & static_cast<Word>(Bits::kUnits << (N - 1) << 1);
        }
        set_beyond(y, cells);
    }

    // Past the end of the volume there is nothing.
    void set_beyond(Label y, const std::array<int, 3>& cells) {
        if (*std::min_element(cells.begin(), cells.end()) == N) return;
        const Word x_beyond = Bits::starting(static_cast<Word>(Bits::kSamples & ~((Word{1} << cells[0]) - 1)));
        for (Label z = 1; z < 2 * N; ++z) {
            const bool all = Dike<N>::start(y) >= cells[1] || Dike<N>::start(z) >= cells[2];
            const Word beyond = all ? ~Word{0} : x_beyond;
            nothing_[y][z] |= beyond;
            highrice_[y][z] &= ~beyond;
        }
    }

    // Two halves of a box, and by each price whether they cost at most as much.
    struct Halves {
        Word nothing[2], highrice[2];

        ISOCORE_INLINED std::array<Word, kSteps> at_most() const {
            const Word one_split = ~(nothing[0] | highrice[0]), other_split = ~(nothing[1] | highrice[1]),
                       none_split = ~(one_split | other_split);
            const Word any_nothing = nothing[0] | nothing[1];
            return {nothing[0] & nothing[1], none_split & any_nothing, none_split, none_split | any_nothing,
                    ~(one_split & other_split)};
        }
    };

    // The least price is at most something if that along any axis is.
    void price_halves(Label y) {
        const DikeLine &nothing = nothing_[y], &highrice = highrice_[y];
        for (std::size_t z = 0; z < 2 * N; ++z) {
            const auto along_x = Halves{{Bits::with_lower_half(nothing[z]), Bits::with_upper_half(nothing[z])},
                                        {Bits::with_lower_half(highrice[z]), Bits::with_upper_half(highrice[z])}}
                                     .at_most();
            for (std::size_t n = 0; n < kSteps; ++n) at_most_[n][y][z] = along_x[n];
        }
        for (std::size_t z = 0; z < N; ++z) {
            const auto along_z =
                Halves{{nothing[2 * z], nothing[2 * z + 1]}, {highrice[2 * z], highrice[2 * z + 1]}}.at_most();
            for (std::size_t n = 0; n < kSteps; ++n) at_most_[n][y][z] |= along_z[n];
        }
        if (Dike<N>::is_unit(y)) return;
        for (std::size_t z = 0; z < 2 * N; ++z) {
            const auto along_y =
                Halves{{nothing_[2 * y][z], nothing_[2 * y + 1][z]}, {highrice_[2 * y][z], highrice_[2 * y + 1][z]}}
                    .at_most();
            for (std::size_t n = 0; n < kSteps; ++n) at_most_[n][y][z] |= along_y[n];
        }
    }

    std::array<std::array<Line, 2 * N + 1>, kMarks> marks_;  // [mark][N + j], then [mark][y]
    std::array<Line, 2 * N> again_y_;                        // ligns along y crossed several times: [y][k]
    std::array<DikeLine, 2 * N + 1> again_z_;                // along z: [N + j][z], then [y][z]
    std::array<std::array<DikeLine, 4>, N + 1> corners_{};   // [j][start or end along x, then along z][z]
    // A bit for each dike along x: does nothing cross the box, may it be one highrice, what do its halves cost? [y][z]
    using Boxes = std::array<DikeLine, 2 * N>;
    Boxes nothing_, highrice_;
    std::array<Boxes, kSteps> at_most_;
    bool one_way_, plain_;  // are all ligns along some axis crossed in one direction, is no cell face alternating?
};

}  // namespace isocore::climbing
