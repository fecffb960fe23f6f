// parallel_each.hpp - The same small task for each of many elements.
#pragma once

#include <algorithm>
#include <cstddef>

#include "common/parallel.hpp"

namespace isocore {

// Runs visit(0) ... visit(count - 1), `at_once` of them one after the other on one thread.
template <class Visit>
void parallel_each(int threads, std::size_t count, std::size_t at_once, const Visit& visit) {
    parallel_for(threads, (count + at_once - 1) / at_once, [&](std::size_t run) {
        const std::size_t end = std::min(count, (run + 1) * at_once);
        for (std::size_t n = run * at_once; n < end; ++n) visit(n);
    });
}

}  // namespace isocore
