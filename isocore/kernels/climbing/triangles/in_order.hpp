// in_order.hpp - Bars are drawn by several threads and come out in their order, without gaps. A thread waits only if it
// is so far ahead of another, which has lost its core perhaps, that what it draws would fill the memory.
#pragma once

#include <algorithm>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

#include "common/array.hpp"

namespace isocore::climbing {

class InOrder {
  public:
    // Of `count` bars, begun in their order; all their triangles fit into `out`. No bar is begun while more than
    // `most_early` numbers are kept aside.
    InOrder(std::size_t count, std::size_t most_early, Array<std::int32_t>& out)
        : most_early_(most_early), early_(count), out_(out) {}

    // Before anything of bar n is drawn.
    void begin(std::size_t n) {
        std::unique_lock<std::mutex> lock(guard_);
        ended_.wait(lock, [&] { return n == next_ || early_size_ <= most_early_ || is_given_up_; });
    }
    // More triangles of bar n, from any thread. What comes before its turn is kept aside.
    void put(std::size_t n, std::span<const std::int32_t> part) {
        const std::lock_guard<std::mutex> lock(guard_);
        if (n == next_) return append(part);
        early_[n].parts.emplace_back(part.begin(), part.end());
        early_size_ += part.size();
    }
    // The end of bar n, each once.
    void end(std::size_t n) {
        const std::lock_guard<std::mutex> lock(guard_);
        early_[n].is_ended = true;
        if (n == next_) ended_.notify_all();
        while (next_ < early_.size() && early_[next_].is_ended) {
            if (++next_ == early_.size()) return;
            for (const auto& part : early_[next_].parts) {
                append(part);
                early_size_ -= part.size();
            }
            early_[next_].parts = {};
        }
    }
    // A bar will never end: nobody is to wait for it.
    void give_up() {
        const std::lock_guard<std::mutex> lock(guard_);
        is_given_up_ = true;
        ended_.notify_all();
    }

  private:
    struct Early {
        std::vector<std::vector<std::int32_t>> parts;
        bool is_ended = false;
    };

    void append(std::span<const std::int32_t> part) {
        std::copy(part.begin(), part.end(), out_.begin() + static_cast<std::ptrdiff_t>(size_));
        size_ += part.size();
    }

    std::mutex guard_;
    std::condition_variable ended_;
    std::size_t most_early_, early_size_ = 0;  // numbers that are kept aside
    std::size_t next_ = 0, size_ = 0;          // the bar whose turn it is, and numbers that are out
    bool is_given_up_ = false;
    std::vector<Early> early_;
    Array<std::int32_t>& out_;
};

}  // namespace isocore::climbing
