#include "samples/crossed_edges.hpp"

#include <bit>

namespace isocore {

std::array<std::uint32_t, 3> count_crossings(const SignGrid& signs, std::size_t j, std::size_t k) {
    std::uint32_t x = 0, y = 0, z = 0;
    const auto ones = [](std::uint64_t word) { return static_cast<std::uint32_t>(std::popcount(word)); };
    for (std::size_t w = 0; w < signs.words; ++w) {
        x += ones(crossed_edges(signs, 0, j, k, w));
        y += ones(crossed_edges(signs, 1, j, k, w));
        z += ones(crossed_edges(signs, 2, j, k, w));
    }
    return {x, y, z};
}

}  // namespace isocore
