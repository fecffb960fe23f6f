// ligns.hpp - The crossings of a block, lign by lign.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/array.hpp"

namespace isocore::climbing {

// Ligns are numbered by their axis and their place along the other two. Functions are told how many samples a lign has, so
// that those who know it beforehand have it folded in.
struct Ligns {
    std::vector<std::uint64_t> crossed;  // the crossed edges of each, one bit per lower sample
    Array<float> shares;                 // by edge: where it is crossed, as a share of the way

    static constexpr std::size_t lign(std::size_t samples, std::size_t axis, int first, int second) {
        return axis * samples * samples + static_cast<std::size_t>(first) + samples * static_cast<std::size_t>(second);
    }
    // Of the edge that starts so far along a lign.
    static constexpr std::size_t edge(std::size_t samples, std::size_t lign, int along) { return lign * samples + static_cast<std::size_t>(along); }

    void clear(std::size_t samples) {
        crossed.assign(3 * samples * samples, 0);
        shares.resize(3 * samples * samples * samples);
    }
};

}  // namespace isocore::climbing
