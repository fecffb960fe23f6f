// shared_cells.hpp - Work sharing for the walk. A thread without cells waits here; the others look now and then whether
// cells are `wanted`, and give half of theirs away. Which thread gets which cells is left open.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "common/array.hpp"
#include "common/spin.hpp"

namespace isocore::thinning {

class SharedCells {
  public:
    // Calls work(cells) for one lot of cells after the other, until no lot is left and no thread works that could give
    // one.
    template <class Work>
    void take_turns(const Work& work) {
        Array<std::int32_t> lot;
        while (take(lot)) {
            const Turn turn(*this);
            work(lot);
        }
    }

    bool wanted() const { return waiting_.load(std::memory_order_relaxed) > offered_.load(std::memory_order_relaxed); }

    void give(Array<std::int32_t>&& lot) {
        if (lot.empty()) return;
        const std::lock_guard<std::mutex> lock(guard_);
        lots_.push_back(std::move(lot));
        offered_.store(lots_.size(), std::memory_order_relaxed);
    }

  private:
    // Ends even if the work throws: the others would wait for ever.
    struct Turn {
        explicit Turn(SharedCells& all) : cells(all) {}
        ~Turn() { cells.working_.fetch_sub(1, std::memory_order_relaxed); }
        Turn(const Turn&) = delete;
        Turn& operator=(const Turn&) = delete;
        SharedCells& cells;
    };

    // Does not sleep: a whole walk may take less time than waking a thread.
    bool take(Array<std::int32_t>& lot) {
        waiting_.fetch_add(1, std::memory_order_relaxed);
        const auto may_go_on = [this] {
            return offered_.load(std::memory_order_relaxed) > 0 || working_.load(std::memory_order_relaxed) == 0;
        };
        for (;;) {
            if (!spin_until(may_go_on)) {
                std::this_thread::yield();
                continue;
            }
            const std::lock_guard<std::mutex> lock(guard_);
            const bool found = !lots_.empty();
            // Threads start to work and give only while they hold the lock or work, so nothing can come any more.
            if (!found && working_.load(std::memory_order_relaxed) > 0) continue;
            waiting_.fetch_sub(1, std::memory_order_relaxed);
            if (!found) return false;
            lot = std::move(lots_.back());
            lots_.pop_back();
            offered_.store(lots_.size(), std::memory_order_relaxed);
            working_.fetch_add(1, std::memory_order_relaxed);
            return true;
        }
    }

    std::mutex guard_;
    std::vector<Array<std::int32_t>> lots_;
    std::atomic<std::size_t> offered_{0}, waiting_{0}, working_{0};
};

}  // namespace isocore::thinning
