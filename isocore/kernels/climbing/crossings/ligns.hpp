// ligns.hpp - The crossings of a block, lign by lign.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/array.hpp"

namespace isocore::climbing {

// Ligns are numbered by their axis and their place along the other two. Functions are told how many samples a lign has,
// so that those who know it beforehand have it folded in.
class Ligns {
  public:
    // Of a block with so many samples per lign.
    explicit Ligns(std::size_t samples) : samples_(samples) {
        crossed.resize(3 * samples * samples);
        shares.resize(crossed.size() * samples);
    }

    std::vector<std::uint64_t> crossed;  // the crossed edges of each, one bit per lower sample
    Array<float> shares;                 // by edge: where it is crossed, as a share of the way

    static constexpr std::size_t lign(std::size_t samples, std::size_t axis, int first, int second) {
        return axis * samples * samples + static_cast<std::size_t>(first) + samples * static_cast<std::size_t>(second);
    }
    // Of the edge that starts so far along a lign.
    static constexpr std::size_t edge(std::size_t samples, std::size_t lign, int along) {
        return lign * samples + static_cast<std::size_t>(along);
    }

    // The edges along an axis that start in row (j, k) of the block, by the sample i where they do.
    struct Row {
        std::uint32_t lign, lign_step, along, along_step;
    };
    static Row row(std::size_t samples, std::size_t axis, int j, int k) {
        const auto size = static_cast<std::uint32_t>(samples), a = static_cast<std::uint32_t>(axis),
                   y = static_cast<std::uint32_t>(j), z = static_cast<std::uint32_t>(k);
        const std::array<std::uint32_t, 3> ligns{y + size * z, size * z, size * y}, alongs{0, y, z};
        return {a * size * size + ligns[a], a != 0, alongs[a], a == 0};
    }
    // Notes that edge i of a row is crossed, and returns the edge's number.
    std::size_t cross(const Row& row, int i) {
        const std::uint32_t lign = row.lign + row.lign_step * static_cast<std::uint32_t>(i),
                            along = row.along + row.along_step * static_cast<std::uint32_t>(i);
        crossed[lign] |= std::uint64_t{1} << along;
        return edge(samples_, lign, static_cast<int>(along));
    }

    void clear() { std::fill(crossed.begin(), crossed.end(), 0); }

  private:
    std::size_t samples_;  // of a lign
};

}  // namespace isocore::climbing
