// The survey of a block, in three passes, none of which branches on what a box holds:
//   1. mark(): rows along x are marked, one word per row: which of its samples, or of its steps from one sample to the
//      next, are crossed in which direction, or start an alternating face.
//   2. sum_up_y(), sum_up_z(): marks of rows are OR-ed up the dyadic tree, as in a segment tree, from the units along y
//      to all dikes along y, then along z. What is left is one word [y][z] of marked samples or steps along x.
//   3. judge(): DikeBits turns that word into a bit for each dike along x.
#include "climbing/boxes/survey.hpp"

#include <algorithm>
#include <tuple>

#include "common/inlined.hpp"
#include "tables/box_corners.hpp"

namespace isocore::climbing {
namespace {

// The cell faces with alternating corners, where a word holds the sign of one corner of each face: `one` and `other`
// are the two neighbours of `first`, and `last` is opposite to it.
template <class Word>
ISOCORE_INLINED Word alternating(Word first, Word one, Word other, Word last) {
    return (first ^ one) & (first ^ other) & ~(first ^ last);
}

template <class AnyLine>
ISOCORE_INLINED void unite(AnyLine& out, const AnyLine& a, const AnyLine& b) {
    for (std::size_t n = 0; n < out.size(); ++n) out[n] = a[n] | b[n];
}

// ORs lines up from the unit dikes along y, lines[N] to lines[2 N - 1], to all dikes. The units come as N steps, or as
// N + 1 samples, of which each unit dike has two.
template <class AnyLine, std::size_t count>
void sum_up_y(std::array<AnyLine, count>& lines, bool steps) {
    constexpr std::size_t N = (count - 1) / 2;
    if (!steps) {
        for (std::size_t j = 0; j < N; ++j) unite(lines[N + j], lines[N + j], lines[N + j + 1]);
    }
    for (std::size_t y = N - 1; y >= 1; --y) unite(lines[y], lines[2 * y], lines[2 * y + 1]);
}

// ORs words up from the 2 `count` dikes of one length along z to the `count` dikes twice as long, and so on; a
// template, so that the loops of each level vectorise.
template <std::size_t count, class DikeLine>
ISOCORE_INLINED void sum_up_levels(DikeLine& line) {
    if constexpr (count > 0) {
        for (std::size_t z = 0; z < count; ++z) line[count + z] = line[2 * count + 2 * z] | line[2 * count + 2 * z + 1];
        sum_up_levels<count / 2>(line);
    } else {
        line[0] = 0;
    }
}

// ORs the words of samples or steps along z up to all dikes along z.
template <class Line, class DikeLine>
ISOCORE_INLINED void sum_up_z(const Line& line, bool steps, DikeLine& out) {
    constexpr std::size_t N = std::tuple_size_v<DikeLine> / 2;
    for (std::size_t k = 0; k < N; ++k) out[N + k] = steps ? line[k] : line[k] | line[k + 1];
    sum_up_levels<N / 2>(out);
}

// Both halves of boxes along one axis, a bit for each box: do they hold nothing, may they be highrices?
template <class Word>
struct HalfPair {
    Word nothing[2], highrice[2];

    // Is the price of both together kPrices[n] of Survey or less?
    ISOCORE_INLINED std::array<Word, 5> at_most() const {
        const Word one_split = ~(nothing[0] | highrice[0]), other_split = ~(nothing[1] | highrice[1]),
                   none_split = ~(one_split | other_split);
        const Word any_nothing = nothing[0] | nothing[1];
        return {nothing[0] & nothing[1], none_split & any_nothing, none_split, none_split | any_nothing,
                ~(one_split & other_split)};
    }
};

}  // namespace

template <int N>
void Survey<N>::take(const Block<N>& block, bool with_halves) {
    mark(block);
    for (Label y = 1; y < 2 * N; ++y) judge(y, block.cells);
    if (!with_halves) return;
    for (Label y = 1; y < 2 * N; ++y) price_halves(y);
}

// A mark is of samples or of steps along y, and of samples or of steps along z. (Along x, x_in, x_out, alternating_xy
// and alternating_xz are of steps, the others of samples; again_x is of dikes already.)
template <int N>
constexpr bool Survey<N>::steps_along_y(std::size_t mark) {
    return mark == y_in || mark == y_out || mark == alternating_xy || mark == alternating_yz;
}
template <int N>
constexpr bool Survey<N>::steps_along_z(std::size_t mark) {
    return mark == z_in || mark == z_out || mark == alternating_xz || mark == alternating_yz;
}

template <int N>
void Survey<N>::mark(const Block<N>& block) {
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
    mark_again_y();
}

// Marks what starts in plane j of the block: in and out by the direction in which a step is crossed, seen along the
// axis; alternating faces at their lowest corner; and dikes along x that are crossed more than once.
template <int N>
void Survey<N>::mark_plane(const Block<N>& block, std::size_t j) {
    using Bits = DikeBits<N>;
    const Line &here = block.rows[j], &next = block.rows[std::min<std::size_t>(j + 1, N)];
    const auto line = [&](std::size_t m) -> Line& { return marks_[m][N + j]; };
    for (std::size_t k = 0; k <= N; ++k) {
        const Word row = here[k], right = next[k], along = row >> 1;
        line(x_in)[k] = ~row & along & Bits::kUnits;
        line(x_out)[k] = row & ~along & Bits::kUnits;
        line(y_in)[k] = ~row & right;
        line(y_out)[k] = row & ~right;
        line(alternating_xy)[k] = alternating<Word>(row, right, along, right >> 1) & Bits::kUnits;
        line(again_x)[k] = Bits::crossed_again(row);
    }
    for (std::size_t k = 0; k < N; ++k) {
        const Word row = here[k], right = next[k], up = here[k + 1];
        line(z_in)[k] = ~row & up;
        line(z_out)[k] = row & ~up;
        line(alternating_xz)[k] = alternating<Word>(row, up, row >> 1, up >> 1) & Bits::kUnits;
        line(alternating_yz)[k] = alternating<Word>(row, right, up, next[k + 1]);
    }
    for (const std::size_t m : {z_in, z_out, alternating_xz, alternating_yz}) line(m)[N] = 0;
}

// Notes, for all pairs of a dike along x and one along z in plane j, the signs at the four corners of their rectangle.
template <int N>
void Survey<N>::mark_corners(const Line& rows, std::size_t j) {
    Line starting, ending;
    for (std::size_t k = 0; k <= N; ++k) {
        starting[k] = DikeBits<N>::starting(rows[k]);
        ending[k] = DikeBits<N>::ending(rows[k]);
    }
    for (Label z = 1; z < 2 * N; ++z) {
        const auto low = static_cast<std::size_t>(Dike<N>::start(z)), high = static_cast<std::size_t>(Dike<N>::end(z));
        corners_[j][0][z] = starting[low];
        corners_[j][1][z] = ending[low];
        corners_[j][2][z] = starting[high];
        corners_[j][3][z] = ending[high];
    }
}

// Marks the ligns along z of plane j that are crossed more than once, a bit for each x: as DikeBits::crossed_again
// does, with dikes as words instead of bits. Needs z_in and z_out of the plane.
template <int N>
void Survey<N>::mark_again_z(std::size_t j) {
    DikeLine crossed, &again = again_z_[N + j];
    again = {};
    for (std::size_t k = 0; k < N; ++k) crossed[N + k] = marks_[z_in][N + j][k] | marks_[z_out][N + j][k];
    for (std::size_t z = N - 1; z >= 1; --z) {
        crossed[z] = crossed[2 * z] | crossed[2 * z + 1];
        again[z] = again[2 * z] | again[2 * z + 1] | (crossed[2 * z] & crossed[2 * z + 1]);
    }
}

// The same along y, for all dikes. Needs y_in and y_out summed up along y.
template <int N>
void Survey<N>::mark_again_y() {
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

template <int N>
bool Survey<N>::has_none(std::size_t mark) const {
    Word found = 0;
    for (std::size_t j = 0; j <= N; ++j) {
        for (std::size_t k = 0; k <= N; ++k) found |= marks_[mark][N + j][k];
    }
    return found == 0;
}

// Answers for all boxes over dike y along y.
template <int N>
void Survey<N>::judge(Label y, const std::array<int, 3>& cells) {
    DikeLine bad, both_ways{};
    find_bad(y, bad);
    if (!one_way_) find_both_ways(y, both_ways);
    const auto &low = corners_[static_cast<std::size_t>(Dike<N>::start(y))],
               &high = corners_[static_cast<std::size_t>(Dike<N>::end(y))];
    for (std::size_t z = 0; z < 2 * N; ++z) {
        const BoxCorners<Word> box(
            {low[0][z], low[1][z], high[0][z], high[1][z], low[2][z], low[3][z], high[2][z], high[3][z]});
        nothing_[y][z] = ~(box.crossed | bad[z]);
        highrice_[y][z] = box.disk & ~bad[z] & ~both_ways[z];
    }
    if (Dike<N>::is_unit(y)) {  // a single cell that is crossed is a highrice
        for (std::size_t z = N; z < 2 * N; ++z)
            highrice_[y][z] |= ~nothing_[y][z] & static_cast<Word>(DikeBits<N>::kUnits << (N - 1) << 1);
    }
    set_beyond(y, cells);
}

// The boxes that are not simple, or in which a cell face is alternating.
template <int N>
ISOCORE_INLINED void Survey<N>::find_bad(Label y, DikeLine& bad) const {
    using Bits = DikeBits<N>;
    DikeLine x, again;
    sum_up_z(again_y_[y], false, again);
    sum_up_z(marks_[again_x][y], steps_along_z(again_x), x);
    for (std::size_t z = 0; z < 2 * N; ++z) bad[z] = x[z] | Bits::over_samples(again[z] | again_z_[y][z]);
    if (plain_) return;
    DikeLine xy, xz, yz;
    sum_up_z(marks_[alternating_xy][y], steps_along_z(alternating_xy), xy);
    sum_up_z(marks_[alternating_xz][y], steps_along_z(alternating_xz), xz);
    sum_up_z(marks_[alternating_yz][y], steps_along_z(alternating_yz), yz);
    for (std::size_t z = 0; z < 2 * N; ++z) bad[z] |= Bits::over_steps(xy[z] | xz[z]) | Bits::over_samples(yz[z]);
}

// The boxes of which ligns along every axis are crossed in both directions.
template <int N>
ISOCORE_INLINED void Survey<N>::find_both_ways(Label y, DikeLine& both_ways) const {
    using Bits = DikeBits<N>;
    std::array<DikeLine, z_out + 1> marks;
    for (std::size_t m = x_in; m <= z_out; ++m) sum_up_z(marks_[m][y], steps_along_z(m), marks[m]);
    for (std::size_t z = 0; z < 2 * N; ++z) {
        both_ways[z] = Bits::over_steps(marks[x_in][z]) & Bits::over_steps(marks[x_out][z]) &
                       Bits::over_samples(marks[y_in][z]) & Bits::over_samples(marks[y_out][z]) &
                       Bits::over_samples(marks[z_in][z]) & Bits::over_samples(marks[z_out][z]);
    }
}

// Boxes that start at or past the end of the volume hold nothing.
template <int N>
void Survey<N>::set_beyond(Label y, const std::array<int, 3>& cells) {
    if (*std::min_element(cells.begin(), cells.end()) == N) return;
    const Word x_beyond =
        DikeBits<N>::starting(static_cast<Word>(DikeBits<N>::kSamples & ~((Word{1} << cells[0]) - 1)));
    for (Label z = 1; z < 2 * N; ++z) {
        const bool all = Dike<N>::start(y) >= cells[1] || Dike<N>::start(z) >= cells[2];
        const Word beyond = all ? ~Word{0} : x_beyond;
        nothing_[y][z] |= beyond;
        highrice_[y][z] &= ~beyond;
    }
}

// The least price of the halves of each box over dike y: it is at most some price if that along any axis is.
template <int N>
void Survey<N>::price_halves(Label y) {
    using Bits = DikeBits<N>;
    const DikeLine &nothing = nothing_[y], &highrice = highrice_[y];
    for (std::size_t z = 0; z < 2 * N; ++z) {
        const auto along_x = HalfPair<Word>{{Bits::with_lower_half(nothing[z]), Bits::with_upper_half(nothing[z])},
                                            {Bits::with_lower_half(highrice[z]), Bits::with_upper_half(highrice[z])}}
                                 .at_most();
        for (std::size_t n = 0; n < kSteps; ++n) at_most_[n][y][z] = along_x[n];
    }
    for (std::size_t z = 0; z < N; ++z) {
        const auto along_z =
            HalfPair<Word>{{nothing[2 * z], nothing[2 * z + 1]}, {highrice[2 * z], highrice[2 * z + 1]}}.at_most();
        for (std::size_t n = 0; n < kSteps; ++n) at_most_[n][y][z] |= along_z[n];
    }
    if (Dike<N>::is_unit(y)) return;
    for (std::size_t z = 0; z < 2 * N; ++z) {
        const auto along_y =
            HalfPair<Word>{{nothing_[2 * y][z], nothing_[2 * y + 1][z]}, {highrice_[2 * y][z], highrice_[2 * y + 1][z]}}
                .at_most();
        for (std::size_t n = 0; n < kSteps; ++n) at_most_[n][y][z] |= along_y[n];
    }
}

template class Survey<1>;
template class Survey<2>;
template class Survey<4>;
template class Survey<8>;
template class Survey<16>;
template class Survey<32>;

}  // namespace isocore::climbing
