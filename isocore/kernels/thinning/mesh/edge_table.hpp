// edge_table.hpp - Numbers edges in the order in which they are first seen: a hash table with open addressing, for the
// edges of one lot of cells.
#pragma once

#include <algorithm>
#include <array>
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

// Edges in the order in which they were first seen.
class EdgeList {
  public:
    std::size_t size() const { return count_; }
    EdgeKey operator[](std::size_t place) const { return edges_[place + 1]; }

    void push_back(EdgeKey edge) {
        make_room(1);
        edges_[++count_] = edge;
    }

  private:
    friend class EdgeTable;
    void make_room(std::size_t more) { edges_.resize(std::max(edges_.size(), count_ + more + 2)); }

    Array<EdgeKey> edges_;  // the one that is searched for, then those seen
    std::uint32_t count_ = 0;
};

// Finds edges in one list at a time. A thread keeps its table from one list to the next, and so in its cache.
class EdgeTable {
  public:
    // Empties the table and the list, and makes room for about so many edges; it grows where there are many more.
    // Whether a search must go on to another slot is unpredictable, so hardly one ever must.
    void start(std::size_t expected, EdgeList& list) {
        clear(std::bit_ceil(16 * expected + 1));
        list.count_ = 0;
    }

    // Writes the place of each edge among those of the list, where a new edge gets the next one.
    void place(const EdgeKey* edges, std::size_t size, std::uint32_t* out, EdgeList& list) {
        while (2 * (list.count_ + size) > slots_) grow(list);
        list.make_room(size);
        with_slots([&](auto* slots) { place(slots, edges, size, out, list); });
    }

    // Calls visit(place among the others, place in the list) for those of the other edges that are in the list.
    template <class Visit>
    void match(const EdgeList& others, EdgeList& list, const Visit& visit) {
        list.make_room(0);
        with_slots([&](auto* slots) { match(slots, others, list, visit); });
    }

  private:
    // Half of so many places can be told in 16 bits. Slots of 16 bits take half of the cache.
    static constexpr std::size_t kMostNarrow = std::size_t{1} << 16;

    // Where an edge may stand.
    struct Slots {
        explicit Slots(std::size_t size) : mask(size - 1), shift(64 - std::countr_zero(size)) {}
        std::size_t first(EdgeKey edge) const { return edge * std::uint64_t{0x9e3779b97f4a7c15} >> shift; }
        std::size_t next(std::size_t slot) const { return (slot + 1) & mask; }
        std::size_t mask;
        int shift;
    };

    template <class Work>
    void with_slots(const Work& work) {
        slots_ <= kMostNarrow ? work(narrow_.data()) : work(wide_.data());
    }

    void clear(std::size_t slots) {
        slots_ = slots;
        slots <= kMostNarrow ? narrow_.assign(slots, 0) : wide_.assign(slots, 0);
    }

    // Slots count places from 1, and an empty slot leads to the edge that is searched for: so a search ends on one
    // condition. Whether an edge is new is unpredictable, so there is no branch on it: every edge is written as if it
    // were.
    template <class Slot>
    void place(Slot* slots, const EdgeKey* edges, std::size_t size, std::uint32_t* out, EdgeList& list) const {
        EdgeKey *const seen = list.edges_.data(), &wanted = seen[0];
        std::uint32_t count = list.count_;
        const Slots slot_of(slots_);
        for (std::size_t n = 0; n < size; ++n) {
            const EdgeKey edge = wanted = edges[n];
            std::size_t slot = slot_of.first(edge);
            std::uint32_t known = slots[slot];
            while (seen[known] != edge) {
                slot = slot_of.next(slot);
                known = slots[slot];
            }
            const std::uint32_t fresh = known == 0, place = known | ((count + 1) & -fresh);
            slots[slot] = static_cast<Slot>(place);
            seen[count + 1] = edge;
            count += fresh;
            out[n] = place - 1;
        }
        list.count_ = count;
    }

    // Most of the others lead to empty slots. Which do is unpredictable, so they are told apart first, some at a time.
    template <class Slot, class Visit>
    void match(const Slot* slots, const EdgeList& others, EdgeList& list, const Visit& visit) const {
        constexpr std::size_t kSome = 256;
        std::array<std::size_t, kSome> candidates;
        EdgeKey *const seen = list.edges_.data(), &wanted = seen[0];
        const Slots slot_of(slots_);
        for (std::size_t first = 0; first < others.size(); first += kSome) {
            std::size_t count = 0;
            for (std::size_t place = first, end = std::min(others.size(), first + kSome); place < end; ++place) {
                candidates[count] = place;
                count += slots[slot_of.first(others[place])] != 0;
            }
            for (std::size_t n = 0; n < count; ++n) {
                const EdgeKey edge = wanted = others[candidates[n]];
                std::size_t slot = slot_of.first(edge);
                while (seen[slots[slot]] != edge) slot = slot_of.next(slot);
                if (slots[slot] != 0) visit(candidates[n], std::size_t{slots[slot]} - 1);
            }
        }
    }

    void grow(const EdgeList& list) {
        clear(2 * slots_);
        with_slots([&](auto* slots) { place_again(slots, list); });
    }

    template <class Slot>
    void place_again(Slot* slots, const EdgeList& list) const {
        const Slots slot_of(slots_);
        for (std::uint32_t place = 1; place <= list.count_; ++place) {
            std::size_t slot = slot_of.first(list.edges_[place]);
            while (slots[slot] != 0) slot = slot_of.next(slot);
            slots[slot] = static_cast<Slot>(place);
        }
    }

    Array<std::uint16_t> narrow_;  // places from 1 on, or 0; in use where there are few slots
    Array<std::uint32_t> wide_;    // the same for many
    std::size_t slots_ = 0;
};

}  // namespace isocore::thinning
