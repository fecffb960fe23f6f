// ligns.hpp - The crossings of a block, lign by lign: which edges of a lign are crossed, and where.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/array.hpp"

namespace isocore::climbing {

// The edges along one axis that start in row (j, k) of a block, in terms of ligns: the edge at sample i belongs to lign
// number lign + lign_step * i, and starts `along` + along_step * i samples along it. A row along x is one lign; the
// edges along y (or z) that start in a row belong to one lign each.
struct LignRow {
    std::uint32_t lign, lign_step, along, along_step;
};

// Ligns are numbered by their axis and their place along the other two axes, the lower one first. Functions are told
// how many samples a lign has, so that callers to which it is a constant have it folded in.
class Ligns {
  public:
    // samples: of a lign, one more than the block has cells.
    explicit Ligns(std::size_t samples) : samples_(samples) {
        crossed.resize(3 * samples * samples);
        shares.resize(crossed.size() * samples);
    }

    std::vector<std::uint64_t> crossed;  // by lign: its crossed edges, a bit each at the lower sample
    Array<float> shares;                 // by edge: where it is crossed, t in [0, 1]; undefined if it is not

    static constexpr std::size_t lign(std::size_t samples, std::size_t axis, int first, int second) {
        return axis * samples * samples + static_cast<std::size_t>(first) + samples * static_cast<std::size_t>(second);
    }
    // The number of the edge that starts `along` samples along a lign.
    static constexpr std::size_t edge(std::size_t samples, std::size_t lign, int along) {
        return lign * samples + static_cast<std::size_t>(along);
    }

    static LignRow row(std::size_t samples, std::size_t axis, int j, int k) {
        const auto size = static_cast<std::uint32_t>(samples), a = static_cast<std::uint32_t>(axis),
                   y = static_cast<std::uint32_t>(j), z = static_cast<std::uint32_t>(k);
        const std::array<std::uint32_t, 3> ligns{y + size * z, size * z, size * y}, alongs{0, y, z};
        return {a * size * size + ligns[a], a != 0, alongs[a], a == 0};
    }
    // Notes that the edge of a row at sample i is crossed, and returns the edge's number.
    std::size_t cross(const LignRow& row, int i) {
        const std::uint32_t lign = row.lign + row.lign_step * static_cast<std::uint32_t>(i),
                            along = row.along + row.along_step * static_cast<std::uint32_t>(i);
        crossed[lign] |= std::uint64_t{1} << along;
        return edge(samples_, lign, static_cast<int>(along));
    }

    void clear() { std::fill(crossed.begin(), crossed.end(), 0); }

  private:
    std::size_t samples_;
};

}  // namespace isocore::climbing
