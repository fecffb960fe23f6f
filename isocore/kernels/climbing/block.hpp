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
            for (int j = 0; j <= N; ++j) look(j, k, j < N, k < N, kSamples, kSamples >> 1, directions_, alternating_);
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
        if (is_graph(directions_, alternating_ != 0)) return true;
        Directions directions{};
        Word alternating = 0;
        const Word here = mask(Dikes::start(x), Dikes::end(x));
        for (int k = Dikes::start(z); k <= Dikes::end(z); ++k) {
            for (int j = Dikes::start(y); j <= Dikes::end(y); ++j) {
                look(j, k, j < Dikes::end(y), k < Dikes::end(z), here, here >> 1 & here, directions, alternating);
            }
        }
        return is_graph(directions, alternating != 0);
    }

    std::array<int, 3> cells{};  // per axis; fewer than N at the volume's end

  private:
    static constexpr Word kSamples = static_cast<Word>((std::uint64_t{1} << (N + 1)) - 1);
    static constexpr std::size_t index(int n) { return static_cast<std::size_t>(n); }
    static constexpr int middle(Label x) { return Dikes::start(x) + Dikes::length(x) / 2; }
    // Samples first ... last.
    static constexpr Word mask(int first, int last) {
        return static_cast<Word>(((std::uint64_t{2} << last) - 1) & ~((std::uint64_t{1} << first) - 1));
    }

    // Crossings into and out of the inside, per axis.
    using Directions = std::array<std::array<Word, 2>, 3>;

    static bool is_graph(const Directions& directions, bool alternating) {
        const auto one_way = [&](std::size_t axis) { return directions[axis][0] == 0 || directions[axis][1] == 0; };
        return !alternating && (one_way(0) || one_way(1) || one_way(2));
    }

    // Adds what row (j, k) and its next neighbours, where they belong to the box, tell of the samples `here`; `starts`
    // are those with a next neighbour along the row.
    void look(int j, int k, bool next_j, bool next_k, Word here, Word starts, Directions& directions, Word& alternating) const {
        const Word row = samples_[index(k)][index(j)];
        const auto pass = [&](std::size_t axis, Word next, Word valid) {
            directions[axis][0] |= ~row & next & valid;
            directions[axis][1] |= row & ~next & valid;
        };
        const auto alternates = [&](Word a, Word b) { return (a ^ a >> 1) & (b ^ b >> 1) & (a ^ b) & starts; };
        pass(0, row >> 1, starts);
        if (next_j) {
            pass(1, samples_[index(k)][index(j + 1)], here);
            alternating |= alternates(row, samples_[index(k)][index(j + 1)]);
        }
        if (next_k) {
            pass(2, samples_[index(k + 1)][index(j)], here);
            alternating |= alternates(row, samples_[index(k + 1)][index(j)]);
        }
        if (next_j && next_k) {
            const Word right = samples_[index(k)][index(j + 1)], up = samples_[index(k + 1)][index(j)];
            const Word both = samples_[index(k + 1)][index(j + 1)];
            alternating |= (row ^ right) & (row ^ up) & ~(row ^ both) & here;
        }
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
    Directions directions_;                                              // of the whole block
    Word alternating_;
};

}  // namespace isocore::climbing
