// Rows of signs, which are rounded to bytes, against the samples.
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "check.hpp"
#include "common/grid.hpp"
#include "samples/signs.hpp"
#include "small_volumes.hpp"

namespace {

using namespace isocore;

// Of a padded grid, 0 for the padding.
bool expected(const std::vector<std::uint8_t>& data, const Dims& dims, std::size_t pad, std::size_t i, std::size_t j,
              std::size_t k) {
    const std::array<std::size_t, 3> at{i - pad, j - pad, k - pad};  // past any end where it would be negative
    for (std::size_t a = 0; a < 3; ++a) {
        if (at[a] >= dims[a]) return false;
    }
    return data[at[0] + dims[0] * (at[1] + dims[1] * at[2])] > 2;
}

void every_reading_of_a_row_gives_its_samples() {
    for (std::size_t length : {2u, 7u, 8u, 9u, 57u, 63u, 64u, 65u, 71u, 128u, 130u}) {
        for (const bool padded : {false, true}) {
            const Dims dims{length, 3, 2};
            const auto data = noise<std::uint8_t>(dims, 6, static_cast<unsigned>(length));
            const std::size_t pad = padded ? 1 : 0;
            for (const int threads : {1, 3}) {
                const SignGrid signs = classify(GridView<std::uint8_t>{data.data(), dims}, 2.5, false, padded, threads);
                for (std::size_t k = 0; k < signs.dims[2]; ++k) {
                    for (std::size_t j = 0; j < signs.dims[1]; ++j) {
                        const SignRow row = signs.row(j, k);
                        for (std::size_t i = 0; i < signs.dims[0]; ++i) {
                            const bool sign = expected(data, dims, pad, i, j, k);
                            CHECK(signs.at(i, j, k) == sign);
                            CHECK((row.word(i / 64) >> i % 64 & 1) == sign);
                            CHECK((row.from(i) & 1) == sign);
                            if (i > 0) CHECK((row.next_word((i - 1) / 64) >> (i - 1) % 64 & 1) == sign);
                            if (i >= 56) CHECK((row.from(i - 56) >> 56 & 1) == sign);
                        }
                    }
                }
            }
        }
    }
}

}  // namespace

void test_signs() { every_reading_of_a_row_gives_its_samples(); }
