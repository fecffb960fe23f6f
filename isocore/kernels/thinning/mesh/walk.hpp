// walk.hpp - The walk itself, on several threads: which cells the isosurface meets.
//
// Each thread walks breadth first through cells of its own, and a mark per cell says whether somebody has found it. Two
// threads may find a cell at once; then both take its step, which is the same. So the order of the walk is left open,
// but not what it finds: a set of cells and their signs, which the marks hold in the order of the cells' numbers.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "common/corner_signs.hpp"
#include "common/crew.hpp"
#include "common/prefetch.hpp"
#include "thinning/mesh/faces.hpp"
#include "thinning/mesh/neighbours.hpp"
#include "thinning/mesh/scratch.hpp"
#include "thinning/mesh/shared_cells.hpp"
#include "thinning/mesh/thinning.hpp"
#include "thinning/range_lookup.hpp"

namespace isocore::thinning {

// The cells as an isovalue meets them. Loops that write marks copy it: its pointers stay in registers then.
template <class Cell, class Value>
struct MetCells {
    const std::int32_t* records;
    const Value* values;
    mesh::CornerSigns<Value> corner_signs;

    const std::int32_t* record(std::int32_t cell) const {
        return records + kRecord<Cell> * static_cast<std::size_t>(cell);
    }

    // Which corners of a cell are inside.
    mesh::Mask signs(std::int32_t cell) const { return corner_signs.template of<Cell>(values, record(cell)); }

    void prefetch_record(std::int32_t cell) const {
        ISOCORE_PREFETCH(record(cell));
        if constexpr (64 % (4 * kRecord<Cell>) != 0) ISOCORE_PREFETCH(record(cell) + kRecord<Cell> - 1);
    }
    void prefetch_values(std::int32_t cell) const {
        for (std::size_t n = 0; n < Cell::kCorners; ++n) ISOCORE_PREFETCH(values + record(cell)[n]);
    }
};

template <class Cell, class Value>
class Walk {
  public:
    Walk(const mesh::Field<Value>& field, const PartView& part, double isovalue, WalkScratch& scratch)
        : part_(part),
          isovalue_(isovalue),
          met_{part.records, field.values, mesh::CornerSigns<Value>(isovalue)},
          scratch_(scratch) {
        scratch.marks.resize(part.cells);
    }

    // Visits every cell that can be reached from the seeds, and leaves them in the scratch memory.
    void run(Crew& crew) {
        Array<std::int32_t> seeds;
        RangeLookup(part_.low, part_.high, part_.skeleton_size).find(isovalue_, [&](std::size_t n) {
            seeds.push_back(part_.skeleton[n]);
        });
        seeds_ = seeds.size();
        met_collapsed_ = std::any_of(seeds.begin(), seeds.end(),
                                     [&](std::int32_t cell) { return is_collapsed<Cell>(met_.record(cell)); });
        const Marks::Setter marks = scratch_.marks.setter();
        std::erase_if(seeds, [&](std::int32_t cell) { return !marks.find(cell); });
        if (seeds.empty()) return;
        if (scratch_.queues.size() < crew.size()) scratch_.queues.resize(crew.size());
        SharedCells shared;
        shared.give(std::move(seeds));
        std::atomic<std::size_t> visits{0};
        crew.together([&](std::size_t member) {
            shared.take_turns([&](const Array<std::int32_t>& lot) {
                visits += follow(lot, scratch_.queues[member], crew.size() == 1 ? nullptr : &shared);
            });
        });
        collect(crew, visits);
    }

    std::size_t seeds() const { return seeds_; }
    // Is any visited cell one that names a point twice? Such a cell is glued to no other, so it can but be a seed.
    bool met_collapsed() const { return met_collapsed_; }
    std::size_t size() const { return size_; }
    const std::int32_t* cells() const { return scratch_.cells.data(); }  // that were visited, ascending
    const std::uint8_t* signs() const { return scratch_.signs.data(); }  // which corners of each are inside

    const std::int32_t* record(std::int32_t cell) const { return met_.record(cell); }
    const MetCells<Cell, Value>& met() const { return met_; }

  private:
    static constexpr std::size_t kRecordsAhead = 40, kValuesAhead = 8;  // cells
    static constexpr std::size_t kSteps = 64;  // between two looks at whether others want cells

    // Walks from the cells of a lot; breadth first, so that it is known well ahead which records will be needed.
    // Returns how many cells it visits.
    std::size_t follow(const Array<std::int32_t>& lot, Array<std::int32_t>& queue, SharedCells* shared) {
        std::size_t head = 0, count = lot.size();
        queue.resize(std::max(queue.size(), count));
        std::copy(lot.begin(), lot.end(), queue.begin());
        while (head < count) {
            const std::size_t end = std::min(count, head + kSteps), room = count + Cell::kFaces * kSteps;
            if (room > queue.size()) queue.resize(2 * room);
            count = take_steps(queue.data(), head, end, count);
            head = end;
            if (shared == nullptr || count - head < kSteps || !shared->wanted()) continue;
            const std::size_t kept = count - (count - head) / 2;
            std::int32_t* const cells = queue.data();
            // The highest half, so that threads hardly come to the same part of the mesh.
            std::nth_element(cells + head, cells + kept, cells + count);
            shared->give({cells + kept, cells + count});
            count = kept;
        }
        return count;
    }

    // Where some steps lead to.
    struct Steps {
        std::array<std::array<std::int32_t, Cell::kFaces>, kSteps> neighbours;
        std::array<std::uint8_t, kSteps> signs;
    };

    // Takes a step from each of the cells between head and end, writes the neighbours that are new behind all `count`
    // cells, where there is room for them, and returns how many cells that makes. First where all steps lead to, then
    // the marks there: so the processor waits for many of them at once. Which neighbours are new is unpredictable, so
    // there is no branch on it.
    std::size_t take_steps(std::int32_t* cells, std::size_t head, std::size_t end, std::size_t count) const {
        const Marks::Setter marks = scratch_.marks.setter();
        Steps steps;
        look_around(cells, head, end, count, marks, steps);
        for (std::size_t n = 0; n < end - head; ++n) {
            for_each(steps.neighbours[n], [&](std::int32_t next) {
                cells[count] = next;
                count += marks.find(next);
            });
            marks.set_signs(cells[head + n], steps.signs[n]);
        }
        return count;
    }

    void look_around(const std::int32_t* cells, std::size_t head, std::size_t end, std::size_t count,
                     const Marks::Setter& marks, Steps& steps) const {
        const MetCells<Cell, Value> met = met_;
        for (std::size_t n = 0; n < end - head; ++n) {
            const std::int32_t* const ahead = cells + head + n;
            if (head + n + kRecordsAhead < count) {
                met.prefetch_record(ahead[kRecordsAhead]);
                met.prefetch_values(ahead[kValuesAhead]);
            }
            const mesh::Mask signs = met.signs(*ahead);
            steps.neighbours[n] = neighbours(Cell{}, *ahead, met.record(*ahead) + Cell::kCorners, signs);
            steps.signs[n] = static_cast<std::uint8_t>(signs);
            for_each(steps.neighbours[n], [&](std::int32_t next) { marks.prefetch(next); });
        }
    }

    // Lists the visited cells, ascending, and their signs. Visits are more than cells where threads have met.
    void collect(Crew& crew, std::size_t visits) {
        scratch_.cells.resize(std::max(scratch_.cells.size(), visits));
        scratch_.signs.resize(std::max(scratch_.signs.size(), visits));
        Marks& marks = scratch_.marks;
        if (crew.size() == 1) {  // then no chunk need be counted before it is listed
            for (std::size_t chunk = 0; chunk < marks.chunks(); ++chunk) size_ = collect(chunk, size_);
            return;
        }
        std::vector<std::size_t> first(marks.chunks() + 1);
        crew.share(marks.chunks(), [&](std::size_t, std::size_t chunk) { first[chunk + 1] = marks.count(chunk); });
        std::partial_sum(first.begin(), first.end(), first.begin());
        size_ = first.back();
        crew.share(marks.chunks(), [&](std::size_t, std::size_t chunk) { collect(chunk, first[chunk]); });
    }

    // Lists those of a chunk, and returns where those of the next one begin. Where threads have lost a cell's signs,
    // they are found anew.
    std::size_t collect(std::size_t chunk, std::size_t first) {
        scratch_.marks.take(chunk, [&](std::size_t base, const auto& marks, std::uint64_t visited) {
            std::int32_t* cells = scratch_.cells.data() + first;  // pointers that stay in registers
            std::uint8_t* signs = scratch_.signs.data() + first;
            first += static_cast<std::size_t>(std::popcount(visited));
            for (; visited != 0; visited &= visited - 1) {
                const auto place = static_cast<std::size_t>(std::countr_zero(visited));
                const auto cell = static_cast<std::int32_t>(base + place);
                const std::uint8_t mark = marks[place];
                *cells++ = cell;
                *signs++ = mark != Marks::kFound ? mark : static_cast<std::uint8_t>(met_.signs(cell));
            }
        });
        return first;
    }

    const PartView& part_;
    double isovalue_;
    MetCells<Cell, Value> met_;
    WalkScratch& scratch_;
    std::size_t seeds_ = 0, size_ = 0;
    bool met_collapsed_ = false;
};

}  // namespace isocore::thinning
