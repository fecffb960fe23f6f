// block.hpp - One block of N^3 cells as bits, and the questions climbing asks of it. Is every lign of a dyadic box
// crossed at most once (simple)? Two loads and two masks answer it. Is the box a graph: are its ligns along some axis
// all crossed in the same direction, and has no cell face in it alternating corners? Mostly the whole block is.
//
// Past the end of the volume the last sample is repeated, so ragged blocks need no special case here.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <type_traits>

#include "climbing/dike.hpp"
#include "common/signs.hpp"

namespace isocore::climbing {

template <int N>
class Block {
  public:
    using Word = std::conditional_t<(N <= 16), std::uint32_t, std::uint64_t>;
    using Dikes = Dike<N>;

    // Reads the block that starts at sample `origin`. False if all its samples lie on one side.
    bool load(const SignGrid& signs, const std::array<std::size_t, 3>& origin) {
        for (std::size_t a = 0; a < 3; ++a) cells[a] = static_cast<int>(std::min<std::size_t>(N, signs.dims[a] - 1 - origin[a]));
        const std::size_t w = origin[0] / 64, shift = origin[0] % 64;
        const bool two_words = shift + static_cast<std::size_t>(cells[0]) >= 64;
        const Word kept = mask(0, cells[0]);
        Word any = 0, all = kSamples;
        for (int k = 0; k <= N; ++k) {
            for (int j = 0; j <= N; ++j) {
                const std::uint64_t* row = signs.row(origin[1] + static_cast<std::size_t>(std::min(j, cells[1])),
                                                     origin[2] + static_cast<std::size_t>(std::min(k, cells[2])));
                Word bits = static_cast<Word>(row[w] >> shift | (two_words ? row[w + 1] << 1 << (63 - shift) : 0)) & kept;
                if (bits >> cells[0] & 1) bits |= kSamples & ~kept;
                samples_[index(k)][index(j)] = bits;
                any |= bits;
                all &= bits;
            }
        }
        return any != 0 && all != kSamples;
    }

    // Fills the tables that simple() and graph() read.
    void survey() {
        directions_ = {};
        alternating_ = 0;
        for (int k = 0; k <= N; ++k) {
            for (int j = 0; j <= N; ++j) {
                const Word row = samples(j, k), starts = kSamples >> 1;
                const auto pass = [&](std::size_t axis, Word next, Word valid) {
                    directions_[axis][0] |= ~row & next & valid;
                    directions_[axis][1] |= row & ~next & valid;
                };
                pass(0, row >> 1, starts);
                if (j < N) pass(1, samples(j + 1, k), kSamples);
                if (k < N) pass(2, samples(j, k + 1), kSamples);
                alternating_ |= alternating(j, k, j < N, k < N, kSamples, starts);
            }
        }
        for (int k = 0; k <= N; ++k) survey_x(k);
        survey_across<false>();
        survey_across<true>();
        close(close(rows_x_), several_x_);
        close(rows_y_, several_yz_);
        std::array<std::array<Word, 2 * N>, 2 * N> other;
        close(rows_z_, other);
        for (Label y = 1; y < 2 * N; ++y) {
            for (Label z = 1; z < 2 * N; ++z) several_yz_[y][z] |= other[z][y];
        }
    }

    bool simple(Label x, Label y, Label z) const {
        const bool crossed_twice = several_yz_[y][z] & mask(Dikes::start(x), Dikes::end(x));
        return !crossed_twice && (Dikes::is_unit(x) || !(several_x_[y][z] >> middle(x) & 1));
    }

    // The eight corner signs of a box, numbered as in cube.hpp.
    unsigned corners(Label x, Label y, Label z) const {
        unsigned out = 0, place = 0;
        for (const int k : {Dikes::start(z), Dikes::end(z)}) {
            for (const int j : {Dikes::start(y), Dikes::end(y)}) {
                const Word row = samples_[index(k)][index(j)];
                out |= static_cast<unsigned>((row >> Dikes::start(x) & 1) | (row >> Dikes::end(x) & 1) << 1) << place;
                place += 2;
            }
        }
        return out;
    }

    // Of a simple box: with disk corners it then holds a disk, whatever happens between its corners.
    bool graph(Label x, Label y, Label z) const {
        if (alternating_ && alternates(x, y, z)) return false;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (!directions_[axis][0] || !directions_[axis][1]) return true;
        }
        return one_way<1>(x, y, z) || one_way<2>(x, y, z) || one_way<0>(x, y, z);
    }

    Word samples(int j, int k) const { return samples_[index(k)][index(j)]; }

    std::array<int, 3> cells{};  // per axis; fewer than N at the volume's end

  private:
    static constexpr Word kSamples = static_cast<Word>((std::uint64_t{1} << (N + 1)) - 1);
    static constexpr std::size_t index(int n) { return static_cast<std::size_t>(n); }
    static constexpr int middle(Label x) { return Dikes::start(x) + Dikes::length(x) / 2; }
    // Samples first ... last.
    static constexpr Word mask(int first, int last) {
        return static_cast<Word>(((std::uint64_t{2} << last) - 1) & ~((std::uint64_t{1} << first) - 1));
    }

    // Are all ligns of the box along an axis crossed in the same direction, if at all?
    template <int axis>
    bool one_way(Label x, Label y, Label z) const {
        const Word here = mask(Dikes::start(x), Dikes::end(x)), valid = axis == 0 ? here >> 1 & here : here;
        Word in = 0, out = 0;
        for (int k = Dikes::start(z); k <= Dikes::end(z) - (axis == 2); ++k) {
            for (int j = Dikes::start(y); j <= Dikes::end(y) - (axis == 1); ++j) {
                const Word row = samples(j, k), next = axis == 0 ? row >> 1 : axis == 1 ? samples(j + 1, k) : samples(j, k + 1);
                in |= ~row & next & valid;
                out |= row & ~next & valid;
            }
        }
        return in == 0 || out == 0;
    }

    // Has a cell face in the box alternating corners?
    bool alternates(Label x, Label y, Label z) const {
        const Word here = mask(Dikes::start(x), Dikes::end(x)), starts = here >> 1 & here;
        Word found = 0;
        for (int k = Dikes::start(z); k <= Dikes::end(z); ++k) {
            for (int j = Dikes::start(y); j <= Dikes::end(y); ++j) found |= alternating(j, k, j < Dikes::end(y), k < Dikes::end(z), here, starts);
        }
        return found != 0;
    }

    // The alternating cell faces that start in row (j, k), of the samples `here` and the cells `starts`.
    Word alternating(int j, int k, bool next_j, bool next_k, Word here, Word starts) const {
        const Word row = samples(j, k), right = next_j ? samples(j + 1, k) : row, up = next_k ? samples(j, k + 1) : row;
        const auto in_plane = [&](Word other) { return (row ^ row >> 1) & (other ^ other >> 1) & (row ^ other) & starts; };
        Word found = in_plane(right) | in_plane(up);
        if (next_j && next_k) found |= (row ^ right) & (row ^ up) & ~(row ^ samples(j + 1, k + 1)) & here;
        return found;
    }

    // For each row of plane k: bit middle(x) tells that dike x is crossed several times. Middles of all dikes differ.
    void survey_x(int k) {
        for (int j = 0; j <= N; ++j) {
            const Word row = samples_[index(k)][index(j)];
            Word any = (row ^ row >> 1) & (kSamples >> 1), several = 0, out = 0;
            for (int half = 1; half < N; half *= 2) {
                several |= several >> half | (any & any >> half);
                any |= any >> half;
                Word starts = 0;
                for (int s = 0; s < N; s += 2 * half) starts |= Word{1} << s;
                any &= starts;
                several &= starts;
                out |= several << half;
            }
            rows_x_[index(j)][index(k)] = out;
        }
    }

    // The same across the rows, one word for N + 1 ligns: rows_y_[y][k] and rows_z_[z][j].
    template <bool along_z>
    void survey_across() {
        std::array<std::array<Word, N + 1>, 2 * N> any;
        auto& several = along_z ? rows_z_ : rows_y_;
        for (int n = 0; n <= N; ++n) {
            for (int m = 0; m < N; ++m) {
                const Word here = along_z ? samples_[index(m)][index(n)] : samples_[index(n)][index(m)];
                const Word next = along_z ? samples_[index(m + 1)][index(n)] : samples_[index(n)][index(m + 1)];
                any[index(N + m)][index(n)] = here ^ next;
                several[index(N + m)][index(n)] = 0;
            }
        }
        for (std::size_t label = N - 1; label >= 1; --label) {
            const auto &a = any[2 * label], &b = any[2 * label + 1];
            const auto &sa = several[2 * label], &sb = several[2 * label + 1];
            for (std::size_t n = 0; n <= N; ++n) {
                any[label][n] = a[n] | b[n];
                several[label][n] = sa[n] | sb[n] | (a[n] & b[n]);
            }
        }
    }

    // From values per plane to values per dike of planes, both ends included: close() the first range, then the second.
    std::array<std::array<Word, N + 1>, 2 * N> close(const std::array<std::array<Word, N + 1>, N + 1>& rows) const {
        std::array<std::array<Word, N + 1>, 2 * N> out;
        for (std::size_t m = 0; m < N; ++m) {
            for (std::size_t k = 0; k <= N; ++k) out[N + m][k] = rows[m][k] | rows[m + 1][k];
        }
        for (std::size_t label = N - 1; label >= 1; --label) {
            for (std::size_t k = 0; k <= N; ++k) out[label][k] = out[2 * label][k] | out[2 * label + 1][k];
        }
        return out;
    }

    static void close(const std::array<std::array<Word, N + 1>, 2 * N>& rows, std::array<std::array<Word, 2 * N>, 2 * N>& out) {
        for (std::size_t y = 1; y < 2 * N; ++y) {
            for (std::size_t m = 0; m < N; ++m) out[y][N + m] = rows[y][m] | rows[y][m + 1];
            for (std::size_t label = N - 1; label >= 1; --label) out[y][label] = out[y][2 * label] | out[y][2 * label + 1];
        }
    }

    std::array<std::array<Word, N + 1>, N + 1> samples_;  // [k][j], bit i
    std::array<std::array<Word, N + 1>, N + 1> rows_x_;   // [j][k]
    std::array<std::array<Word, N + 1>, 2 * N> rows_y_, rows_z_;
    std::array<std::array<Word, 2 * N>, 2 * N> several_x_, several_yz_;  // [y][z]
    std::array<std::array<Word, 2>, 3> directions_;                      // crossings of the block into and out of the inside
    Word alternating_;
};

}  // namespace isocore::climbing
