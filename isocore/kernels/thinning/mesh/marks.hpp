// marks.hpp - What a walk knows of every cell, in a byte each. Several threads set marks without a locked instruction:
// a cell that two of them find at once is visited twice, which changes nothing, and is rare.
#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>

#include "common/mesh_cells.hpp"
#include "common/prefetch.hpp"

#if defined(__AVX2__)
#include <immintrin.h>
#endif

namespace isocore::thinning {

class Marks {
    using Mark = std::atomic<std::uint8_t>;
    static_assert(sizeof(Mark) == 1);

  public:
    // A cell's mark is 0, then this, then which of its corners are inside. Not all of them are, in a cell that is met.
    static constexpr std::uint8_t kFound = 255;
    static constexpr std::size_t kGroup = 64;  // cells that are looked at together

    // How a loop sets marks: by pointers of its own, since a byte that is written could be a part of anything else.
    class Setter {
      public:
        // Whether nobody had found the cell yet. Without a branch, and so it writes even if somebody had: what the
        // other wrote in the meantime is lost, and the cell's mark may remain kFound.
        bool find(std::int32_t cell) const {
            Mark& mark = marks_[static_cast<std::uint32_t>(cell)];
            const std::uint8_t before = mark.load(std::memory_order_relaxed);
            const bool fresh = before == 0;
            mark.store(static_cast<std::uint8_t>(before | -int{fresh}), std::memory_order_relaxed);
            return fresh;
        }
        void set_signs(std::int32_t cell, mesh::Mask signs) const {
            marks_[static_cast<std::uint32_t>(cell)].store(static_cast<std::uint8_t>(signs), std::memory_order_relaxed);
            groups_[static_cast<std::uint32_t>(cell) / kGroup].store(1, std::memory_order_relaxed);
        }
        void prefetch(std::int32_t cell) const { ISOCORE_PREFETCH(marks_ + cell); }

      private:
        friend class Marks;
        Setter(Mark* marks, Mark* groups) : marks_(marks), groups_(groups) {}
        Mark *marks_, *groups_;
    };

    Setter setter() { return {marks_.get(), groups_.get()}; }

    // Makes room for so many cells.
    void resize(std::size_t cells) {
        if (cells == cells_) return;
        cells_ = cells;
        marks_ = std::make_unique<Mark[]>(kGroup * kGroups * chunks());
        groups_ = std::make_unique<Mark[]>(kGroups * chunks());
    }

    // Cells come in chunks. What follows may be called of several chunks at a time, but not while anybody sets marks.
    std::size_t chunks() const { return (cells_ + kGroup * kGroups - 1) / (kGroup * kGroups); }

    // How many cells of a chunk have marks.
    std::size_t count(std::size_t chunk) const {
        std::size_t all = 0;
        for_groups(chunk, [&](std::size_t group) {
            all += static_cast<std::size_t>(std::popcount(not_zero(marks_.get() + kGroup * group)));
        });
        return all;
    }

    // Calls visit(first cell, marks, set of those that are not 0) for the groups of a chunk, ascending, and leaves no
    // mark behind.
    template <class Visit>
    void take(std::size_t chunk, const Visit& visit) {
        for_groups(chunk, [&](std::size_t group) {
            Mark* const there = marks_.get() + kGroup * group;
            std::array<std::uint8_t, kGroup> marks;
            std::memcpy(marks.data(), static_cast<const void*>(there), kGroup);
            visit(kGroup * group, marks, not_zero(there));
            std::memset(static_cast<void*>(there), 0, kGroup);
            groups_[group].store(0, std::memory_order_relaxed);
        });
    }

  private:
    static constexpr std::size_t kGroups = 512;  // in a chunk

    // Calls visit(group) for those with signs, ascending. Most have none, and eight of them are passed over at once;
    // the first one's byte is the lowest.
    template <class Visit>
    void for_groups(std::size_t chunk, const Visit& visit) const {
        for (std::size_t first = kGroups * chunk; first < kGroups * (chunk + 1); first += 8) {
            std::uint64_t eight;
            std::memcpy(&eight, static_cast<const void*>(groups_.get() + first), 8);
            for (; eight != 0; eight &= eight - 1) visit(first + static_cast<std::size_t>(std::countr_zero(eight)) / 8);
        }
    }

    static std::uint64_t not_zero(const Mark* group) {
        std::uint64_t set = 0;
#if defined(__AVX2__)
        for (std::size_t n = 0; n < kGroup; n += 32) {
            const __m256i marks = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(group + n)),
                          zeros = _mm256_cmpeq_epi8(marks, _mm256_setzero_si256());
            set |= std::uint64_t{~static_cast<std::uint32_t>(_mm256_movemask_epi8(zeros))} << n;
        }
#else
        for (std::size_t n = 0; n < kGroup; ++n)
            set |= std::uint64_t{group[n].load(std::memory_order_relaxed) != 0} << n;
#endif
        return set;
    }

    std::unique_ptr<Mark[]> marks_, groups_;  // by cell; by group: 1 where a cell has signs
    std::size_t cells_ = 0;
};

}  // namespace isocore::thinning
