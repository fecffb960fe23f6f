// in_order.hpp - Bars are drawn by several threads and come out in their order, without gaps and without anyone waiting.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "common/array.hpp"

namespace isocore::climbing {

class InOrder {
  public:
    // Of `count` parts, which all fit into `out`.
    InOrder(std::size_t count, Array<std::int32_t>& out) : early_(count), out_(out) {}

    // Part n, from any thread, each once. One that comes before its turn is kept aside.
    void put(std::size_t n, std::span<const std::int32_t> part) {
        const std::lock_guard<std::mutex> lock(guard_);
        if (n != next_) {
            early_[n].emplace(part.begin(), part.end());
            return;
        }
        append(part);
        for (; next_ < early_.size() && early_[next_]; early_[next_ - 1].reset()) append(*early_[next_]);
    }

  private:
    void append(std::span<const std::int32_t> part) {
        std::copy(part.begin(), part.end(), out_.begin() + static_cast<std::ptrdiff_t>(size_));
        size_ += part.size();
        ++next_;
    }

    std::mutex guard_;
    std::size_t next_ = 0, size_ = 0;  // parts and numbers that are out
    std::vector<std::optional<std::vector<std::int32_t>>> early_;
    Array<std::int32_t>& out_;
};

}  // namespace isocore::climbing
