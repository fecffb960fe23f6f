// marks.hpp - Which samples of a plane have vertices on them, and the numbers of these vertices. Only every eighth
// sample keeps a number, those between are counted from there: a rank query. So all of it stays in the cache, where a
// number for each sample would not.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/bit_fields.hpp"

namespace isocore::labels {

class Marks {
  public:
    static constexpr std::size_t kWord = 8;  // marks that are looked at together

    // None at first. `size` and kWord samples more may be asked for.
    explicit Marks(std::size_t size) : marks_(size + 2 * kWord, 0), numbers_(size / kWord + 2, 0) {}

    // A byte for each sample: a bit for each of its three vertices that is there. To be written to.
    std::uint8_t* data() { return marks_.data(); }
    // The marks of eight samples, the first of them lowest.
    std::uint64_t word(std::size_t at) const { return load_bits(marks_.data() + at); }

    std::size_t vertices() const {
        std::size_t sum = 0;
        for (std::size_t n = 0; n < numbers_.size(); ++n)
            sum += static_cast<std::size_t>(std::popcount(word(n * kWord)));
        return sum;
    }

    // Numbers the vertices from `next` on, in the order of samples and of their bits. Then calls visit(at, mark) for
    // each sample that has any.
    template <class Visit>
    void number(std::int32_t next, const Visit& visit) {
        for (std::size_t n = 0; n < numbers_.size(); ++n) {
            numbers_[n] = next;
            std::uint64_t left = word(n * kWord);
            next += std::popcount(left);
            while (left != 0) {
                const int byte = std::countr_zero(left) / 8;
                visit(n * kWord + static_cast<std::size_t>(byte), static_cast<unsigned>(left >> 8 * byte & 7));
                left &= ~(std::uint64_t{7} << 8 * byte);
            }
        }
    }

    // The numbers of a sample's vertices, and of the next sample's. What stands in place of one that is not there means
    // nothing.
    struct Numbers {
        std::array<std::int32_t, 3> here, next;
    };
    Numbers numbers(std::size_t at) const {
        const std::uint64_t before = word(at / kWord * kWord) & ((std::uint64_t{1} << at % kWord * 8) - 1);
        const unsigned here = marks_[at], next = marks_[at + 1];
        const std::int32_t first = numbers_[at / kWord] + std::popcount(before), second = first + kVertices[here];
        return {{first, first + kVertices[here & 1], first + kVertices[here & 3]},
                {second, second + kVertices[next & 1], second + kVertices[next & 3]}};
    }

  private:
    static constexpr std::array<std::uint8_t, 8> kVertices{0, 1, 1, 2, 1, 2, 2, 3};  // of a mark

    std::vector<std::uint8_t> marks_;
    std::vector<std::int32_t> numbers_;  // of the first vertex of each word, or what it would be
};

}  // namespace isocore::labels
