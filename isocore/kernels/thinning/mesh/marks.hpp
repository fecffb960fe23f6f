// marks.hpp - What a walk knows of every cell, in a byte each. Several threads set marks without a locked instruction:
// a cell that two of them find at once is visited twice, which changes nothing, and is rare.
#pragma once

#include <array>
#include <atomic>
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
        void prefetch(std::size_t cell) const { ISOCORE_PREFETCH(marks_ + cell); }

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
        marks_ = std::make_unique<Mark[]>(kGroup * groups());
        groups_ = std::make_unique<Mark[]>(groups());
    }

    // Calls visit(first cell, marks, set of those that are not 0) for every group that has some, ascending, and leaves
    // none behind. Nobody may set marks meanwhile.
    template <class Visit>
    void take(const Visit& visit) {
        std::array<std::uint8_t, kWord> touched;
        std::array<std::uint8_t, kGroup> marks;
        for (std::size_t first = 0; first < groups(); first += kWord) {
            take(groups_.get() + first, touched);
            if (touched == std::array<std::uint8_t, kWord>{}) continue;
            for (std::size_t n = 0; n < kWord; ++n) {
                if (touched[n] == 0) continue;
                take(marks_.get() + kGroup * (first + n), marks);
                visit(kGroup * (first + n), marks, not_zero(marks));
            }
        }
    }

  private:
    static constexpr std::size_t kWord = 8;  // groups that are passed over together

    std::size_t groups() const { return (cells_ + kGroup * kWord - 1) / (kGroup * kWord) * kWord; }

    // Several marks at once, of which none remains.
    template <std::size_t count>
    static void take(Mark* marks, std::array<std::uint8_t, count>& out) {
        std::memcpy(out.data(), static_cast<void*>(marks), count);
        std::memset(static_cast<void*>(marks), 0, count);
    }

    static std::uint64_t not_zero(const std::array<std::uint8_t, kGroup>& marks) {
        std::uint64_t set = 0;
#if defined(__AVX2__)
        for (std::size_t n = 0; n < kGroup; n += 32) {
            const __m256i some = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(marks.data() + n)),
                          zeros = _mm256_cmpeq_epi8(some, _mm256_setzero_si256());
            set |= std::uint64_t{~static_cast<std::uint32_t>(_mm256_movemask_epi8(zeros))} << n;
        }
#else
        for (std::size_t n = 0; n < kGroup; ++n) set |= std::uint64_t{marks[n] != 0} << n;
#endif
        return set;
    }

    std::unique_ptr<Mark[]> marks_, groups_;  // by cell; by group: 1 where a cell has signs
    std::size_t cells_ = 0;
};

}  // namespace isocore::thinning
