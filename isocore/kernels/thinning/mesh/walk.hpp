// walk.hpp - The walk itself, on several threads: which cells the isosurface meets.
//
// Each thread walks breadth first through cells of its own, and a bit per cell says who came first. So the order of the
// walk is left open, but not what it finds: a set of cells, which the bits hold in the order of their numbers.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "common/corner_signs.hpp"
#include "common/crew.hpp"
#include "common/prefetch.hpp"
#include "thinning/mesh/neighbours.hpp"
#include "thinning/mesh/scratch.hpp"
#include "thinning/mesh/shared_cells.hpp"
#include "thinning/mesh/thinning.hpp"
#include "thinning/range_lookup.hpp"

namespace isocore::thinning {

template <class Cell, class Value>
class Walk {
  public:
    Walk(const mesh::Field<Value>& field, const PartView& part, double isovalue, WalkScratch& scratch)
        : field_(field), part_(part), isovalue_(isovalue), corner_signs_(isovalue), scratch_(scratch) {
        const std::size_t words = (part.cells + kWord - 1) / kWord;
        if (scratch.visited.size() != words) scratch.visited = std::vector<std::atomic<std::uint64_t>>(words);
        scratch.cells.clear();
    }

    // Visits every cell that can be reached from the seeds, and leaves them in the scratch memory.
    void run(Crew& crew) {
        Array<std::int32_t> lot;
        RangeLookup(part_.low, part_.high, part_.skeleton_size).find(isovalue_, [&](std::size_t n) {
            lot.push_back(part_.skeleton[n]);
        });
        seeds_ = lot.size();
        std::erase_if(lot, [&](std::int32_t cell) { return !mark(cell, true); });
        if (lot.empty()) return;
        SharedCells shared;
        shared.give(std::move(lot));
        crew.together([&](std::size_t) {
            shared.take_turns([&](Array<std::int32_t>& cells) { follow(cells, crew.size() == 1 ? nullptr : &shared); });
        });
        collect();
    }

    std::size_t seeds() const { return seeds_; }
    std::size_t size() const { return scratch_.cells.size(); }
    const std::int32_t* cells() const { return scratch_.cells.data(); }  // that were visited, ascending

    const std::int32_t* record(std::int32_t cell) const {
        return part_.records + kRecord<Cell> * static_cast<std::size_t>(cell);
    }

    // Which corners of a cell are inside.
    mesh::Mask signs(const std::int32_t* corners) const {
        return corner_signs_.template of<Cell>(field_.values, corners);
    }

    void prefetch_record(std::int32_t cell) const {
        ISOCORE_PREFETCH(record(cell));
        if constexpr (64 % (4 * kRecord<Cell>) != 0) ISOCORE_PREFETCH(record(cell) + kRecord<Cell> - 1);
    }
    void prefetch_values(std::int32_t cell) const {
        for (std::size_t n = 0; n < Cell::kCorners; ++n) ISOCORE_PREFETCH(field_.values + record(cell)[n]);
    }

  private:
    static constexpr std::size_t kWord = 64;  // cells
    static constexpr std::size_t kRecordsAhead = 16, kValuesAhead = 8, kWorthSharing = 64;

    // Walks from the cells of a lot; breadth first, so that it is known well ahead which records will be needed. Behind
    // the cells there is always room for those that one step may find.
    void follow(Array<std::int32_t>& cells, SharedCells* shared) {
        std::size_t count = cells.size();
        for (std::size_t head = 0; head < count; ++head) {
            if (count + Cell::kFaces > cells.size()) cells.resize(2 * count + kWorthSharing);
            if (head + kRecordsAhead < count) prefetch_record(cells[head + kRecordsAhead]);
            if (head + kValuesAhead < count) prefetch_values(cells[head + kValuesAhead]);
            count += step(cells[head], cells.data() + count, shared == nullptr);
            if (shared == nullptr || count - head < kWorthSharing || !shared->wanted()) continue;
            const std::size_t half = (count - head) / 2;
            const auto end = cells.begin() + static_cast<std::ptrdiff_t>(count);
            shared->give({end - static_cast<std::ptrdiff_t>(half), end});
            count -= half;
        }
    }

    // Writes the neighbours that are new and returns how many these are. Which ones is unpredictable, so there is no
    // branch on it where no other thread could come between.
    std::size_t step(std::int32_t cell, std::int32_t* found, bool alone) {
        const std::int32_t* corners = record(cell);
        Neighbours<Cell> across;
        across.find(corners + Cell::kCorners, mesh::kCrossedFaces<Cell>[signs(corners)]);
        return alone ? step_alone(across, found) : step_shared(across, found);
    }

    std::size_t step_alone(const Neighbours<Cell>& across, std::int32_t* found) {
        std::atomic<std::uint64_t>* const visited = scratch_.visited.data();
        std::size_t count = 0;
        for (std::size_t face = 0; face < Cell::kFaces; ++face) {
            const std::uint32_t next = across.cells[face];
            const std::uint64_t bit = across.bit(face) << next % kWord;
            std::atomic<std::uint64_t>& word = visited[next / kWord];
            const std::uint64_t before = word.load(std::memory_order_relaxed);
            word.store(before | bit, std::memory_order_relaxed);
            found[count] = static_cast<std::int32_t>(next);
            count += (bit & ~before) != 0;
        }
        return count;
    }

    std::size_t step_shared(const Neighbours<Cell>& across, std::int32_t* found) {
        std::size_t perhaps = 0, count = 0;
        for (std::size_t face = 0; face < Cell::kFaces; ++face) {
            const std::uint32_t next = across.cells[face];
            const std::uint64_t bit = across.bit(face) << next % kWord,
                                before = scratch_.visited[next / kWord].load(std::memory_order_relaxed);
            found[perhaps] = static_cast<std::int32_t>(next);
            perhaps += (bit & ~before) != 0;
        }
        for (std::size_t n = 0; n < perhaps; ++n) {
            if (mark(found[n], false)) found[count++] = found[n];
        }
        return count;
    }

    // Marks a cell as visited; returns whether it was not. Without other threads no atomic exchange is needed.
    bool mark(std::int32_t cell, bool alone) {
        std::atomic<std::uint64_t>& word = scratch_.visited[static_cast<std::size_t>(cell) / kWord];
        const std::uint64_t bit = std::uint64_t{1} << static_cast<std::size_t>(cell) % kWord,
                            before = word.load(std::memory_order_relaxed);
        if (before & bit) return false;
        if (!alone) return !(word.fetch_or(bit, std::memory_order_relaxed) & bit);
        word.store(before | bit, std::memory_order_relaxed);
        return true;
    }

    // Lists the visited cells, and leaves no bit behind.
    void collect() {
        for (std::size_t word = 0; word < scratch_.visited.size(); ++word) {
            std::uint64_t left = scratch_.visited[word].load(std::memory_order_relaxed);
            if (left == 0) continue;
            scratch_.visited[word].store(0, std::memory_order_relaxed);
            for (; left != 0; left &= left - 1) {
                scratch_.cells.push_back(
                    static_cast<std::int32_t>(kWord * word + static_cast<std::size_t>(std::countr_zero(left))));
            }
        }
    }

    const mesh::Field<Value>& field_;
    const PartView& part_;
    double isovalue_;
    mesh::CornerSigns<Value> corner_signs_;
    WalkScratch& scratch_;
    std::size_t seeds_ = 0;
};

}  // namespace isocore::thinning
