// table.hpp - What was met at a place before.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "common/array.hpp"
#include "common/large_pages.hpp"
#include "common/prefetch.hpp"

namespace isocore {

inline constexpr std::int32_t kNone = -1;

using Place = std::array<double, 3>;

inline Place place_of(const double* points, std::size_t point) {
    return {points[3 * point], points[3 * point + 1], points[3 * point + 2]};
}

// Equal places have equal hashes: adding 0.0 turns -0.0 into 0.0. The low bits of coordinates are often zeros, so the
// high ones are folded down before they are multiplied.
inline std::uint32_t hash(const Place& place) {
    constexpr std::array<std::uint64_t, 3> kFactors{0x9e3779b97f4a7c15u, 0xd6e8feb86659fd93u, 0xbf58476d1ce4e5b9u};
    std::uint64_t sum = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto bits = std::bit_cast<std::uint64_t>(place[axis] + 0.0);
        sum += (bits ^ bits >> 31) * kFactors[axis];
    }
    sum ^= sum >> 32;
    sum *= 0x94d049bb133111ebu;
    return static_cast<std::uint32_t>(sum >> 32);
}

// Numbers entered by a place: a point's coordinates, or the grid cell that it lies in. Open addressing. A slot is four
// bytes: the number, and above it as many of the hash's high bits as there is room for, so that a look at the place
// itself, which lies elsewhere in memory, is seldom in vain. So numbers are less than half as many as there are slots.
// The table grows with what is entered: where most points coincide with others, it stays in the cache.
class Table {
  public:
    // For numbers below `count`, and as many of them.
    explicit Table(std::size_t count) { make_empty(count); }

    // hash_of(number): of each number entered so far.
    template <class HashOf>
    void make_room(std::size_t count, const HashOf& hash_of) {
        const Array<std::uint32_t> old = std::move(slots_);
        const std::uint32_t numbers = numbers_;
        make_empty(count);
        for (const std::uint32_t slot : old) {
            if (slot != kEmpty) enter(hash_of(static_cast<std::int32_t>(slot & numbers)), slot & numbers);
        }
    }

    // For numbers below `count`?
    bool has_room(std::size_t count) const { return count <= numbers_; }

    void prefetch(std::uint32_t hash) const { ISOCORE_PREFETCH(&slots_[hash & (slots_.size() - 1)]); }

    // What was entered at the same place; this number, now, where nothing was.
    template <class Same>
    std::int32_t find_or_enter(std::uint32_t hash, std::int32_t number, const Same& same) {
        std::uint32_t& slot = slots_[find(hash, same)];
        if (slot == kEmpty) slot = (hash & ~numbers_) | static_cast<std::uint32_t>(number);
        return static_cast<std::int32_t>(slot & numbers_);
    }

    // kNone where nothing was.
    template <class Same>
    std::int32_t found(std::uint32_t hash, const Same& same) const {
        const std::uint32_t slot = slots_[find(hash, same)];
        return slot == kEmpty ? kNone : static_cast<std::int32_t>(slot & numbers_);
    }

  private:
    static constexpr std::uint32_t kEmpty = ~std::uint32_t{0};  // the last number is never entered

    void make_empty(std::size_t count) {
        slots_ = large_array<std::uint32_t>(2 * std::bit_ceil(count + 1));
        std::ranges::fill(slots_, kEmpty);
        numbers_ = static_cast<std::uint32_t>(slots_.size() / 2 - 1);
    }

    void enter(std::uint32_t hash, std::uint32_t number) {
        slots_[find(hash, [](std::int32_t) { return false; })] = (hash & ~numbers_) | number;
    }

    // The slot of the same place, or the empty one where it belongs.
    template <class Same>
    std::size_t find(std::uint32_t hash, const Same& same) const {
        std::size_t at = hash & (slots_.size() - 1);
        for (;; at = (at + 1) & (slots_.size() - 1)) {
            const std::uint32_t slot = slots_[at];
            if (slot == kEmpty) return at;
            if ((slot ^ hash) <= numbers_ && same(static_cast<std::int32_t>(slot & numbers_))) return at;
        }
    }

    Array<std::uint32_t> slots_;
    std::uint32_t numbers_ = 0;  // the bits of a slot that are the number
};

}  // namespace isocore
