// parallel.hpp - Independent tasks on a few threads. Which thread runs which task is left open, so a task may
// only write to places that are its own; then the result is the same for any number of threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace isocore {

// Runs task(0) ... task(count - 1). The first exception of any task is thrown again here, after all have ended.
template <class Task>
void parallel_for(int threads, std::size_t count, const Task& task) {
    const std::size_t workers = std::min<std::size_t>(threads < 1 ? 1 : static_cast<std::size_t>(threads), count);
    if (workers <= 1) {
        for (std::size_t i = 0; i < count; ++i) task(i);
        return;
    }
    std::atomic<std::size_t> next{0};
    std::exception_ptr failure;
    std::mutex failure_guard;
    const auto work = [&] {
        try {
            for (std::size_t i = next++; i < count; i = next++) task(i);
        } catch (...) {
            const std::lock_guard<std::mutex> lock(failure_guard);
            if (!failure) failure = std::current_exception();
            next = count;
        }
    };
    std::vector<std::thread> pool;
    pool.reserve(workers - 1);
    for (std::size_t i = 1; i < workers; ++i) pool.emplace_back(work);
    work();
    for (std::thread& thread : pool) thread.join();
    if (failure) std::rethrow_exception(failure);
}

// Runs task(helper, 0) ... task(helper, count - 1). Each thread calls make() once, for a helper that only it uses: its
// scratch memory, for example.
template <class Make, class Task>
void parallel_for(int threads, std::size_t count, const Make& make, const Task& task) {
    std::atomic<std::size_t> next{0};
    parallel_for(threads, std::min(count, static_cast<std::size_t>(std::max(threads, 1))), [&](std::size_t) {
        auto helper = make();
        for (std::size_t i = next++; i < count; i = next++) task(helper, i);
    });
}

}  // namespace isocore
