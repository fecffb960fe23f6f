#include "climbing/boxes/halvings.hpp"

#include <bit>

namespace isocore::climbing {

constexpr HalvingCode::HalvingCode() {
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

constexpr HalvingCode::CodeWord HalvingCode::code_word(unsigned axes, const Halving& halving) const {
    const unsigned fates = static_cast<unsigned>(halving.lower) + 3 * static_cast<unsigned>(halving.upper) - 1;
    const CodeWord axis = of_axes[axes][halving.axis];
    return {static_cast<std::uint8_t>(axis.bits | fates << axis.length), static_cast<std::uint8_t>(axis.length + 3)};
}

// Sets the code word of one axis among `axes`, and the entries of all words of kLongest bits that begin with one of the
// eight codes of its halvings.
constexpr void HalvingCode::set(unsigned axes, unsigned axis, const CodeWord& of_axis) {
    of_axes[axes][axis] = of_axis;
    for (unsigned fates = 1; fates < 9; ++fates) {
        const Halving halving{static_cast<std::uint8_t>(axis), static_cast<Fate>(fates % 3),
                              static_cast<Fate>(fates / 3)};
        const CodeWord own = code_word(axes, halving);
        for (unsigned next = own.bits; next < 1u << kLongest; next += 1u << own.length)
            entries[axes][next] = {halving, own.length};
    }
}

constinit const HalvingCode kHalvingCode;

void Halvings::add(unsigned axes, const Halving& halving) {
    const HalvingCode::CodeWord word = kHalvingCode.code_word(axes, halving);
    append(word.bits, word.length);
}

void Halvings::append(std::uint64_t bits, std::size_t count) {
    const std::size_t word = size_ / 64, bit = size_ % 64;
    if (word + 2 > words_.size()) words_.resize(word + 2);
    words_[word] |= bits << bit;
    words_[word + 1] |= bits >> 1 >> (63 - bit);
    size_ += count;
}

}  // namespace isocore::climbing
