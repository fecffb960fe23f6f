// halvings.hpp - How the blocks of a bar were halved down to highrices, in three to five bits a halving: highrices
// would take six bytes each.
//
// For each block its fate is written, in two bits. If it is halved, its halvings follow in preorder: the halving of a
// piece, then all those within its lower half, then all those within its upper half. Pieces of two cells are left out:
// their halves are cells, and the signs at a cell's corners show what it holds.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "climbing/boxes/piece.hpp"
#include "common/bit_fields.hpp"

namespace isocore::climbing {

// What becomes of a piece: nothing crosses it, it is drawn as one highrice, or it is halved.
enum class Fate : std::uint8_t { nothing, highrice, halved };

// Along which axis a piece is halved, and what becomes of its halves.
struct Halving {
    std::uint8_t axis = 0;
    Fate lower = Fate::nothing, upper = Fate::nothing;
};

// A halving in bits, the lowest first: a prefix code of its axis among the axes along which the piece can be halved,
// then three bits for the fates of the halves, lower + 3 upper - 1 (both nothing does not occur).
//     one axis: no bits    two axes: 0, 1    three axes: x 0, y 10, z 11
struct HalvingCode {
    static constexpr unsigned kLongest = 5;
    struct CodeWord {
        std::uint8_t bits = 0, length = 0;
    };
    struct Entry {
        Halving halving;
        std::uint8_t length = 0;
    };
    std::array<std::array<CodeWord, 4>, 8> of_axes{};  // [the piece's axes, a bit each][the axis it is halved along]
    std::array<std::array<Entry, 1 << kLongest>, 8> entries{};  // [the piece's axes, a bit each][the next bits]

    constexpr HalvingCode();

    constexpr CodeWord code_word(unsigned axes, const Halving& halving) const;

  private:
    constexpr void set(unsigned axes, unsigned axis, const CodeWord& of_axis);
};
extern const HalvingCode kHalvingCode;

// Writes halvings, in the order above.
class Halvings {
  public:
    void add_block(Fate fate) { append(static_cast<std::uint64_t>(fate), 2); }
    // Adds the halving of a piece that can be halved along these axes, a bit each.
    void add(unsigned axes, const Halving& halving);
    void shrink_to_fit() { words_.shrink_to_fit(); }

  private:
    friend class HalvingsReader;

    void append(std::uint64_t bits, std::size_t count);

    std::vector<std::uint64_t> words_;  // one more than needed, so that two can always be written and read
    std::size_t size_ = 0;              // bits
};

// Reads them in the same order.
class HalvingsReader {
  public:
    explicit HalvingsReader(const Halvings& halvings) : words_(halvings.words_.data()) {}

    Fate next_block() {
        const auto fate = static_cast<Fate>(ahead() & 3);
        at_ += 2;
        return fate;
    }
    // The halving of a piece that can be halved along these axes, a bit each.
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
