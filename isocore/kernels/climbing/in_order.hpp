// in_order.hpp - Bars are drawn by several threads and come out in their order, without gaps and without anyone waiting.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

#include "common/array.hpp"

namespace isocore::climbing {

class InOrder {
  public:
    // Of `count` bars, whose triangles all fit into `out`.
    InOrder(std::size_t count, Array<std::int32_t>& out) : early_(count), out_(out) {}

    // More triangles of bar n, from any thread. What comes before its turn is kept aside.
    void put(std::size_t n, std::span<const std::int32_t> part) {
        const std::lock_guard<std::mutex> lock(guard_);
        if (n == next_) append(part);
        else early_[n].parts.emplace_back(part.begin(), part.end());
    }
    // The end of bar n, each once.
    void end(std::size_t n) {
        const std::lock_guard<std::mutex> lock(guard_);
        early_[n].is_ended = true;
        while (next_ < early_.size() && early_[next_].is_ended) {
            if (++next_ == early_.size()) return;
            for (const auto& part : early_[next_].parts) append(part);
            early_[next_].parts = {};
        }
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
    std::size_t next_ = 0, size_ = 0;  // the bar whose turn it is, and numbers that are out
    std::vector<Early> early_;
    Array<std::int32_t>& out_;
};

}  // namespace isocore::climbing
