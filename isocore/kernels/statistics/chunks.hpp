// chunks.hpp - Samples cut into chunks; a thread counts whole chunks, and counts add up to the same in any order.
#pragma once

#include <algorithm>
#include <cstddef>

#include "common/parallel.hpp"

namespace isocore {

inline std::size_t chunk_count(std::size_t count, int threads) {
    const std::size_t wanted = threads < 1 ? 1 : static_cast<std::size_t>(threads);
    return std::clamp<std::size_t>(count / 65536, 1, 4 * wanted);
}

// Runs work(chunk, first, last) over all chunks.
template <class Work>
void over_chunks(std::size_t count, std::size_t chunks, int threads, const Work& work) {
    parallel_for(threads, chunks, [&](std::size_t chunk) {
        work(chunk, count / chunks * chunk, chunk + 1 == chunks ? count : count / chunks * (chunk + 1));
    });
}

}  // namespace isocore
