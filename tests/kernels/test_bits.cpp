// Bits moved close together and back, and visited in their order, against loops over single bits.
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "check.hpp"
#include "common/bit_fields.hpp"
#include "common/set_bits.hpp"

namespace {

using namespace isocore;

void extracted_bits_go_back_to_their_places() {
    std::mt19937_64 random(7);
    for (int trial = 0; trial < 1000; ++trial) {
        const std::uint64_t word = random(), places = random() & (trial % 2 ? random() : ~std::uint64_t{0});
        std::uint64_t expected = 0;
        for (unsigned place = 0, next = 0; place < 64; ++place) {
            if (places >> place & 1) expected |= (word >> place & 1) << next++;
        }
        CHECK(extract_bits(word, places) == expected);
        CHECK(deposit_bits(expected, places) == (word & places));
    }
    CHECK(extract_bits(~std::uint64_t{0}, 0) == 0 && deposit_bits(~std::uint64_t{0}, 0) == 0);
}

void lowest_bits_counts_to_a_whole_word() {
    std::uint64_t expected = 0;
    for (std::size_t count = 0; count <= 64; ++count, expected = expected << 1 | 1)
        CHECK(lowest_bits(count) == expected);
}

void set_bits_come_word_by_word() {
    std::mt19937_64 random(11);
    SetBits<int, 4> found;
    for (int trial = 0; trial < 500; ++trial) {
        std::vector<std::pair<int, int>> expected, visited;
        for (int word = 0; !found.full() && word < 8; ++word) {
            const std::uint64_t bits = random() % 3 ? random() & random() & random() : 0;
            found.add(bits, word);
            for (int bit = 0; bit < 64; ++bit) {
                if (bits >> bit & 1) expected.emplace_back(word, bit);
            }
        }
        found.visit([&](int word, int bit) { visited.emplace_back(word, bit); });
        CHECK(visited == expected);
        CHECK(!found.full());
    }
}

}  // namespace

void test_bits() {
    extracted_bits_go_back_to_their_places();
    lowest_bits_counts_to_a_whole_word();
    set_bits_come_word_by_word();
}
