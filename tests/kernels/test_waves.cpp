// Steps over blocks that follow each other closely: none comes too early, and none is left out.
#include <algorithm>
#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

#include "check.hpp"
#include "common/waves.hpp"

namespace {

using namespace isocore;

void a_step_finds_its_neighbours_one_step_behind_or_done() {
    for (const int threads : {1, 2, 5}) {
        for (const std::size_t blocks : {0, 1, 4, 200}) {
            for (const std::size_t reach : {0, 1, 3}) {
                constexpr std::size_t kSteps = 6;
                std::vector<std::atomic<std::size_t>> done(blocks);
                in_waves(threads, kSteps, blocks, reach, [&](std::size_t step, std::size_t block) {
                    const std::size_t end = std::min(blocks, block + reach + 1);
                    for (std::size_t n = block - std::min(block, reach); n < end; ++n)
                        CHECK(done[n] == step || (n != block && done[n] == step + 1));
                    if (block % 5 == 0) std::this_thread::yield();  // some take longer
                    ++done[block];
                });
                for (const auto& steps : done) CHECK(steps == kSteps);
            }
        }
    }
}

void no_steps_do_nothing() {
    in_waves(2, 0, 10, 1, [](std::size_t, std::size_t) { CHECK(false); });
}

}  // namespace

void test_waves() {
    a_step_finds_its_neighbours_one_step_behind_or_done();
    no_steps_do_nothing();
}
