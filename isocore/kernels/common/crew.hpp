// crew.hpp - Threads for several short pieces of work one after the other: they are started once, as starting them
// takes longer than such a piece.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace isocore {

class Crew {
  public:
    // The thread that makes the crew is one of its members. The others are started when they are first needed.
    explicit Crew(int members) : size_(static_cast<std::size_t>(std::max(members, 1))) {}
    ~Crew() {
        work_ = nullptr;
        call();
        for (std::thread& thread : threads_) thread.join();
    }
    Crew(const Crew&) = delete;
    Crew& operator=(const Crew&) = delete;

    std::size_t size() const { return size_; }

    // Runs work(member) of every member, from 0 on, and waits for all. The first exception of any is thrown again here.
    template <class Work>
    void together(const Work& work) {
        while (threads_.size() + 1 < size_) threads_.emplace_back([this, n = threads_.size() + 1] { serve(n); });
        context_ = &work;
        work_ = [](const void* context, std::size_t member) { (*static_cast<const Work*>(context))(member); };
        busy_.store(threads_.size(), std::memory_order_relaxed);
        call();
        attempt(0);
        while (busy_.load(std::memory_order_acquire) > 0) std::this_thread::yield();
        if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
    }

    // Runs task(member, 0) ... task(member, count - 1), each on whichever member comes first.
    template <class Task>
    void share(std::size_t count, const Task& task) {
        if (count == 1) return task(0, 0);
        std::atomic<std::size_t> next{0};
        together([&](std::size_t member) {
            for (std::size_t n = next++; n < count; n = next++) task(member, n);
        });
    }

  private:
    void call() {
        calls_.fetch_add(1, std::memory_order_release);
        calls_.notify_all();
    }

    void serve(std::size_t member) {
        for (std::uint32_t seen = 0;; ++seen) {
            wait_for_call(seen);
            if (work_ == nullptr) return;
            attempt(member);
            busy_.fetch_sub(1, std::memory_order_release);
        }
    }

    // The next piece of work mostly comes at once, and it takes long to wake a thread that sleeps.
    void wait_for_call(std::uint32_t seen) const {
        constexpr int kPatience = 4096;
        for (int n = 0; n < kPatience; ++n) {
            if (calls_.load(std::memory_order_acquire) != seen) return;
            std::this_thread::yield();
        }
        calls_.wait(seen, std::memory_order_acquire);
    }

    void attempt(std::size_t member) {
        try {
            work_(context_, member);
        } catch (...) {
            const std::lock_guard<std::mutex> lock(guard_);
            if (!failure_) failure_ = std::current_exception();
        }
    }

    std::size_t size_;
    std::vector<std::thread> threads_;
    void (*work_)(const void*, std::size_t) = nullptr;
    const void* context_ = nullptr;
    std::atomic<std::uint32_t> calls_{0};
    std::atomic<std::size_t> busy_{0};
    std::mutex guard_;
    std::exception_ptr failure_;
};

}  // namespace isocore
