// halvings.hpp - How the blocks of a bar were halved down to highrices, in three to five bits a halving: boxes would
// take four bytes each.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "climbing/high_rice.hpp"
#include "common/bit_fields.hpp"

namespace isocore::climbing {

// What halving a block leads to, down to single cells; it may reach past the volume's end. In one word: a byte for each
// low end and for each length, a bit for each axis along which it can be halved, and how often that can be done.
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
    std::uint64_t depth() const { return word_ >> kDepth; }  // 0 for a cell

    // Its halves along an axis.
    struct Halves;
    Halves halves(unsigned axis) const;

    // Without what is past the volume's end; `cells`: of the block.
    HighRice within(const std::array<int, 3>& cells) const {
        const std::uint64_t highs = word_ + (word_ >> kLengths);  // in the lowest three bytes
        HighRice box;
        for (unsigned a = 0; a < 3; ++a) {
            box.low[a] = static_cast<std::uint8_t>(std::min(low(a), cells[a]));
            box.high[a] = static_cast<std::uint8_t>(std::min(static_cast<int>(highs >> 8 * a & 255), cells[a]));
        }
        return box;
    }

  private:
    static constexpr unsigned kLengths = 24, kAxes = 48, kDepth = 51;
    explicit Piece(std::uint64_t word) : word_(word) {}

    std::uint64_t word_;
};

struct Piece::Halves {
    Piece lower, upper;
};

inline Piece::Halves Piece::halves(unsigned axis) const {
    const unsigned byte = 8 * axis;
    const std::uint64_t half = (word_ >> (kLengths + byte) & 255) / 2,
                        is_last = half & 1;  // all lengths are powers of two
    const std::uint64_t lower =
        word_ - (half << (kLengths + byte)) - (is_last << (kAxes + axis)) - (std::uint64_t{1} << kDepth);
    return {Piece(lower), Piece(lower + (half << byte))};
}

// What becomes of a piece.
enum class Fate : std::uint8_t { nothing, highrice, halved };

// How a piece is halved, and what becomes of its halves.
struct Halving {
    std::uint8_t axis = 0;
    Fate lower = Fate::nothing, upper = Fate::nothing;
};

// Up to two bits tell along which axis, where there is a choice, and three what becomes of the halves: at least one of
// them holds something. Cells take nothing, as their corners show what they hold.
struct HalvingCode {
    static constexpr unsigned kLongest = 5;
    struct Word {
        std::uint8_t bits = 0, length = 0;
    };
    struct Entry {
        Halving halving;
        std::uint8_t length = 0;
    };
    std::array<std::array<Word, 4>, 8> of_axes{};               // by the axes to choose from, and the one chosen
    std::array<std::array<Entry, 1 << kLongest>, 8> entries{};  // by the axes to choose from, and the next bits

    constexpr HalvingCode() {
        for (unsigned axes = 1; axes < 8; ++axes) {
            const auto first = static_cast<unsigned>(std::countr_zero(axes)),
                       last = static_cast<unsigned>(std::bit_width(axes) - 1);
            if (first == last)
                set(axes, first, {0, 0});
            else if (axes != 7)
                set(axes, first, {0, 1}), set(axes, last, {1, 1});
            else
                set(axes, 0, {0, 1}), set(axes, 1, {1, 2}), set(axes, 2, {3, 2});
        }
    }

    constexpr Word word(unsigned axes, const Halving& halving) const {
        const unsigned fates = static_cast<unsigned>(halving.lower) + 3 * static_cast<unsigned>(halving.upper) - 1;
        const Word axis = of_axes[axes][halving.axis];
        return {static_cast<std::uint8_t>(axis.bits | fates << axis.length),
                static_cast<std::uint8_t>(axis.length + 3)};
    }

  private:
    constexpr void set(unsigned axes, unsigned axis, const Word& of_axis) {
        of_axes[axes][axis] = of_axis;
        for (unsigned fates = 1; fates < 9; ++fates) {
            const Halving halving{static_cast<std::uint8_t>(axis), static_cast<Fate>(fates % 3),
                                  static_cast<Fate>(fates / 3)};
            const Word own = word(axes, halving);
            for (unsigned next = own.bits; next < 1u << kLongest; next += 1u << own.length)
                entries[axes][next] = {halving, own.length};
        }
    }
};
inline constexpr HalvingCode kHalvingCode;

// Of all pieces of several cells that are halved, but for those of two, whose halves are cells: each before those of
// its lower half, and these before those of its upper half.
class Halvings {
  public:
    void add_block(Fate fate) { append(static_cast<std::uint64_t>(fate), 2); }
    // Of a piece with these axes to choose from.
    void add(unsigned axes, const Halving& halving) {
        const HalvingCode::Word word = kHalvingCode.word(axes, halving);
        append(word.bits, word.length);
    }
    void shrink_to_fit() { words_.shrink_to_fit(); }

  private:
    friend class HalvingsReader;

    void append(std::uint64_t bits, std::size_t count) {
        const std::size_t word = size_ / 64, bit = size_ % 64;
        if (word + 2 > words_.size()) words_.resize(word + 2);
        words_[word] |= bits << bit;
        words_[word + 1] |= bits >> 1 >> (63 - bit);
        size_ += count;
    }

    std::vector<std::uint64_t> words_;  // and one more, to write to and to read from
    std::size_t size_ = 0;              // bits
};

class HalvingsReader {
  public:
    explicit HalvingsReader(const Halvings& halvings) : words_(halvings.words_.data()) {}

    Fate next_block() {
        const auto fate = static_cast<Fate>(ahead() & 3);
        at_ += 2;
        return fate;
    }
    // Of a piece with these axes to choose from.
    Halving next(unsigned axes) {
        const HalvingCode::Entry& entry = kHalvingCode.entries[axes][ahead() & ((1u << HalvingCode::kLongest) - 1)];
        at_ += entry.length;
        return entry.halving;
    }

  private:
    std::uint64_t ahead() const { return bits_from(words_, at_); }

    const std::uint64_t* words_;
    std::size_t at_ = 0;  // bits
};

}  // namespace isocore::climbing
