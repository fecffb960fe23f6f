// edge_table.hpp - Numbers edges in the order in which they are first seen: a hash table with open addressing, small
// enough for the fastest cache where it holds the edges of one lot of cells.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "common/array.hpp"

namespace isocore::thinning {

// An edge by its two points: the lower one in the upper half.
using EdgeKey = std::uint64_t;

// Without a branch: which of the two is lower is unpredictable.
inline EdgeKey edge_key(std::int32_t a, std::int32_t b) {
    const auto first = static_cast<std::uint32_t>(a), both = first ^ static_cast<std::uint32_t>(b),
               low = first ^ (both & -static_cast<std::uint32_t>(b < a));
    return EdgeKey{low} << 32 | (both ^ low);
}
inline std::int32_t low_point(EdgeKey edge) { return static_cast<std::int32_t>(edge >> 32); }
inline std::int32_t high_point(EdgeKey edge) { return static_cast<std::int32_t>(edge); }

class EdgeTable {
  public:
    static constexpr std::uint32_t kNone = ~std::uint32_t{0};

    // Empties the table and makes room for about so many edges; it grows where there are more.
    void start(std::size_t expected) {
        slots_.assign(std::bit_ceil(2 * expected + kAtOnce), kEmpty);
        places_.resize(slots_.size());
        count_ = 0;
    }

    // Writes the place of each edge among those seen so far, where a new edge gets the next one.
    void place(const EdgeKey* edges, std::size_t size, std::uint32_t* out) {
        for (std::size_t n = 0; n < size; n += kAtOnce) {
            const std::size_t some = std::min(kAtOnce, size - n);
            while (2 * (count_ + some) > slots_.size()) grow();
            place_some(edges + n, some, out + n);
        }
    }

    // The place of an edge, or kNone.
    std::uint32_t find(EdgeKey edge) const {
        const std::size_t slot = slot_of(edge, slots_.data(), slots_.size());
        return slots_[slot] == edge ? places_[slot] : kNone;
    }

    std::size_t size() const { return count_; }
    const EdgeKey* edges() const { return edges_.data(); }  // by place

  private:
    static constexpr EdgeKey kEmpty = ~EdgeKey{0};
    static constexpr std::size_t kAtOnce = 64;

    // The slot of an edge, or an empty one for it.
    static std::size_t slot_of(EdgeKey edge, const EdgeKey* slots, std::size_t size) {
        std::size_t slot = edge * std::uint64_t{0x9e3779b97f4a7c15} >> (64 - std::countr_zero(size));
        // One condition for both ends of the search: which of them it will be is unpredictable.
        while (std::min(slots[slot] ^ edge, slots[slot] ^ kEmpty) != 0) slot = (slot + 1) & (size - 1);
        return slot;
    }

    // Whether an edge is new is unpredictable, so there is no branch on it.
    void place_some(const EdgeKey* edges, std::size_t size, std::uint32_t* out) {
        edges_.resize(std::max(edges_.size(), count_ + size + 1));
        EdgeKey *const slots = slots_.data(), *const seen = edges_.data();
        std::uint32_t* const places = places_.data();
        const std::size_t slot_count = slots_.size();
        std::size_t count = count_;
        for (std::size_t n = 0; n < size; ++n) {
            const EdgeKey edge = edges[n];
            const std::size_t slot = slot_of(edge, slots, slot_count);
            const bool found = slots[slot] == edge;
            const std::uint32_t place = found ? places[slot] : static_cast<std::uint32_t>(count);
            slots[slot] = edge;
            places[slot] = place;
            seen[count] = edge;
            count += !found;
            out[n] = place;
        }
        count_ = count;
    }

    void grow() {
        slots_.assign(2 * slots_.size(), kEmpty);
        places_.resize(slots_.size());
        for (std::size_t n = 0; n < count_; ++n) {
            const std::size_t slot = slot_of(edges_[n], slots_.data(), slots_.size());
            slots_[slot] = edges_[n];
            places_[slot] = static_cast<std::uint32_t>(n);
        }
    }

    Array<EdgeKey> slots_, edges_;
    Array<std::uint32_t> places_;  // by slot
    std::size_t count_ = 0;
};

}  // namespace isocore::thinning
