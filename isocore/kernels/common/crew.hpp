// crew.hpp - Threads for many short pieces of work one after the other: they are started once, as starting them takes
// longer than such a piece, and sleep between two that are far apart. Nobody waits for a thread that comes too late to
// take part in one.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "common/spin.hpp"

#if __has_include(<unistd.h>)
#include <unistd.h>
#endif

namespace isocore {

class Crew {
  public:
    // The thread that makes the crew is one of its members. The others are started when they are first needed.
    explicit Crew(int members) : size_(size_for(members)) {}
    ~Crew() {
        if (process_ != this_process()) {  // whose threads cannot be joined here: they are kept for ever
            static_cast<void>(std::make_unique<std::vector<std::thread>>(std::move(threads_)).release());
            return;
        }
        work_ = nullptr;
        turn();
        for (std::thread& thread : threads_) thread.join();
    }
    Crew(const Crew&) = delete;
    Crew& operator=(const Crew&) = delete;

    std::size_t size() const { return size_; }
    // Is it of so many, and in this process? A process that is forked has none of the threads.
    bool is_of(int members) const { return size_ == size_for(members) && process_ == this_process(); }

    // Runs work(0) here, and work(member) of those other members that come before it ends, whose work may be done by
    // then; and waits for them. The first exception of any is thrown again here.
    template <class Work>
    void together(const Work& work) {
        while (threads_.size() + 1 < size_) threads_.emplace_back([this, n = threads_.size() + 1] { serve(n); });
        context_ = &work;
        work_ = [](const void* context, std::size_t member) { (*static_cast<const Work*>(context))(member); };
        turn();
        attempt(0);
        turn();
        wait_for_others();
        if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
    }

    // Runs task(member, 0) ... task(member, count - 1). Every member has a run of its own, which is the same whenever
    // the count is, so that it finds what it wrote in a step before in its cache: to get that from another processor's
    // takes longer than from memory. Who has done its run helps with the others.
    template <class Task>
    void share(std::size_t count, const Task& task) {
        if (count == 1) return task(0, 0);
        for (std::size_t n = 0; n < size_; ++n) {
            runs_[n].next = n * count / size_;
            runs_[n].end = (n + 1) * count / size_;
        }
        together([&](std::size_t member) {
            for (std::size_t n = 0; n < size_; ++n) {
                Run& run = runs_[(member + n) % size_];
                for (std::size_t taken = 0; run.take(taken);) task(member, taken);
            }
        });
    }

  private:
    static std::size_t size_for(int members) { return static_cast<std::size_t>(std::max(members, 1)); }

    static long this_process() {
#if __has_include(<unistd.h>)
        return getpid();
#else
        return 0;  // no process is forked here
#endif
    }

    // Tasks that are left, on a line of the cache of their own.
    struct alignas(64) Run {
        // Sets the next task unless there is none.
        bool take(std::size_t& taken) { return next < end && (taken = next++) < end; }
        std::atomic<std::size_t> next;
        std::size_t end;
    };

    static bool is_open(std::uint32_t turn) { return turn % 2 == 1; }

    // Opens the work to the others, or closes it again.
    void turn() {
        if (is_open(turns_.fetch_add(1) + 1)) turns_.notify_all();
    }

    void wait_for_others() {
        if (spin_until([&] { return working_ == 0; })) return;
        for (std::uint32_t left = working_; left > 0; left = working_) working_.wait(left);
    }

    void serve(std::size_t member) {
        for (std::uint32_t seen = 0;;) {
            if (!spin_until([&] { return turns_ != seen; })) turns_.wait(seen);
            // In this order: who closes the work looks after that whether anybody is working.
            ++working_;
            seen = turns_;
            const bool is_last = is_open(seen) && work_ == nullptr;
            if (is_open(seen) && !is_last) attempt(member);
            if (--working_ == 0) working_.notify_one();
            if (is_last) return;
        }
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
    long process_ = this_process();
    std::vector<Run> runs_ = std::vector<Run>(size_);  // by member
    std::vector<std::thread> threads_;
    void (*work_)(const void*, std::size_t) = nullptr;
    const void* context_ = nullptr;
    std::atomic<std::uint32_t> turns_{0};    // odd while the work is open
    std::atomic<std::uint32_t> working_{0};  // other members
    std::mutex guard_;
    std::exception_ptr failure_;
};

}  // namespace isocore
