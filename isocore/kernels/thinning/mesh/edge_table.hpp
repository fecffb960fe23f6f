// edge_table.hpp - Numbers edges in the order in which they are first seen: a hash table with open addressing, for the
// edges of one lot of cells.
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
    // Empties the table and makes room for about so many edges; it grows where there are many more. Whether a search
    // must go on to another slot is unpredictable, so hardly one ever must.
    void start(std::size_t expected) {
        slots_.assign(std::bit_ceil(4 * expected + 1), 0);
        count_ = 0;
    }

    // Writes the place of each edge among those seen so far, where a new edge gets the next one. Slots count places
    // from 1, and an empty slot leads to the edge that is searched for: so a search ends on one condition. Whether an
    // edge is new is unpredictable, so there is no branch on it: every edge is written as if it were.
    void place(const EdgeKey* edges, std::size_t size, std::uint32_t* out) {
        while (2 * (count_ + size) > slots_.size()) grow();
        edges_.resize(std::max(edges_.size(), count_ + size + 2));
        EdgeKey *const seen = edges_.data(), &wanted = seen[0];
        std::uint32_t* const slots = slots_.data();
        std::uint32_t count = count_;
        const Slots slot_of(slots_.size());
        for (std::size_t n = 0; n < size; ++n) {
            const EdgeKey edge = wanted = edges[n];
            std::size_t slot = slot_of.first(edge);
            while (seen[slots[slot]] != edge) slot = slot_of.next(slot);
            const std::uint32_t known = slots[slot], fresh = known == 0, place = known | ((count + 1) & -fresh);
            slots[slot] = place;
            seen[count + 1] = edge;
            count += fresh;
            out[n] = place - 1;
        }
        count_ = count;
    }

    std::size_t size() const { return count_; }
    EdgeKey operator[](std::size_t place) const { return edges_[place + 1]; }

  private:
    // Where an edge may stand.
    struct Slots {
        explicit Slots(std::size_t size) : mask(size - 1), shift(64 - std::countr_zero(size)) {}
        std::size_t first(EdgeKey edge) const { return edge * std::uint64_t{0x9e3779b97f4a7c15} >> shift; }
        std::size_t next(std::size_t slot) const { return (slot + 1) & mask; }
        std::size_t mask;
        int shift;
    };

    void grow() {
        slots_.assign(2 * slots_.size(), 0);
        const Slots slot_of(slots_.size());
        for (std::uint32_t place = 1; place <= count_; ++place) {
            std::size_t slot = slot_of.first(edges_[place]);
            while (slots_[slot] != 0) slot = slot_of.next(slot);
            slots_[slot] = place;
        }
    }

    Array<std::uint32_t> slots_;  // places from 1 on, or 0
    Array<EdgeKey> edges_;        // the one that is searched for, then those seen
    std::uint32_t count_ = 0;
};

}  // namespace isocore::thinning
