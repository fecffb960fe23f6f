// waves.hpp - Several steps over the blocks of a large array, each step close behind the one before, so that a block is
// still in the cache when the next step comes to it.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

#include "common/parallel.hpp"

namespace isocore {

// Runs task(step, block) of all steps and blocks. Before it, the step before has run for that block and for all that
// are up to `reach` blocks away. Tasks must not throw.
template <class Task>
void in_waves(int threads, std::size_t steps, std::size_t blocks, std::size_t reach, const Task& task) {
    if (steps == 0) return;
    // With few blocks, threads would do little but wait for each other.
    const std::size_t most = blocks / (2 * (reach + 1));
    const std::size_t workers = std::clamp<std::size_t>(most, 1, static_cast<std::size_t>(std::max(threads, 1)));
    const std::size_t lag = reach + 1 + workers / 4;
    const std::size_t waves = blocks + lag * (steps - 1);
    std::vector<std::atomic<bool>> done(steps * blocks);
    const auto wait_for = [&](std::size_t step, std::size_t block) {
        const std::size_t end = std::min(blocks, block + reach + 1);
        for (std::size_t n = block - std::min(block, reach); n < end; ++n) {
            while (!done[step * blocks + n].load(std::memory_order_acquire)) std::this_thread::yield();
        }
    };
    std::atomic<std::size_t> next{0};
    parallel_for(static_cast<int>(workers), workers, [&](std::size_t) {
        for (std::size_t n = next++; n < waves * steps; n = next++) {
            const std::size_t step = n % steps, begin = lag * step, wave = n / steps;
            if (wave < begin || wave - begin >= blocks) continue;
            const std::size_t block = wave - begin;
            if (step > 0) wait_for(step - 1, block);
            task(step, block);
            done[step * blocks + block].store(true, std::memory_order_release);
        }
    });
}

}  // namespace isocore
