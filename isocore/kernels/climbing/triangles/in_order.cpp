#include "climbing/triangles/in_order.hpp"

#include <algorithm>

namespace isocore::climbing {

InOrder::InOrder(std::size_t count, std::size_t most_early, Array<std::int32_t>& out)
    : most_early_(most_early), early_(count), out_(out) {}

void InOrder::begin(std::size_t n) {
    std::unique_lock<std::mutex> lock(guard_);
    ended_.wait(lock, [&] { return n == next_ || early_size_ <= most_early_ || is_given_up_; });
}

void InOrder::put(std::size_t n, std::span<const std::int32_t> part) {
    const std::lock_guard<std::mutex> lock(guard_);
    if (n == next_) return append(part);
    early_[n].parts.emplace_back(part.begin(), part.end());
    early_size_ += part.size();
}

void InOrder::end(std::size_t n) {
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

void InOrder::give_up() {
    const std::lock_guard<std::mutex> lock(guard_);
    is_given_up_ = true;
    ended_.notify_all();
}

void InOrder::append(std::span<const std::int32_t> part) {
    std::copy(part.begin(), part.end(), out_.begin() + static_cast<std::ptrdiff_t>(size_));
    size_ += part.size();
}

}  // namespace isocore::climbing
