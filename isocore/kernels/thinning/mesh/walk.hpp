// walk.hpp - The walk itself, on several threads: which cells the isosurface meets, and how much the cells of every
// block draw.
//
// Each thread walks breadth first through cells of its own, and a bit per cell says who came first. So the order of the
// walk is left open, but not what it finds: a set of cells, which the bits hold in the order of their numbers, block by
// block.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "common/parallel.hpp"
#include "common/prefetch.hpp"
#include "tables/mesh_cases.hpp"
#include "thinning/mesh/shared_cells.hpp"
#include "thinning/mesh/thinning.hpp"
#include "thinning/range_lookup.hpp"

namespace isocore::thinning {

// How much some cells draw; or, as a prefix sum, how much all cells before them draw.
struct Amount {
    std::size_t cells = 0, vertices = 0, middles = 0, triangles = 0;

    Amount& operator+=(const Amount& other) {
        cells += other.cells;
        vertices += other.vertices;
        middles += other.middles;
        triangles += other.triangles;
        return *this;
    }
};

template <class Cell, class Value>
class Walk {
  public:
    static constexpr std::size_t kWord = 64, kBlock = 64 * kWord;  // cells

    Walk(const mesh::Field<Value>& field, const PartView& part, double isovalue)
        : field_(field),
          part_(part),
          isovalue_(isovalue),
          inside_(isovalue, false),
          visited_((part.cells + kWord - 1) / kWord) {}

    // Visits every cell that can be reached from the seeds.
    void run(int threads) {
        Array<std::int32_t> lot;
        RangeLookup(part_.low, part_.high, part_.skeleton_size).find(isovalue_, [&](std::size_t n) {
            lot.push_back(part_.skeleton[n]);
        });
        seeds_ = lot.size();
        std::erase_if(lot, [&](std::int32_t cell) { return !mark(cell, true); });
        blocks_.resize(lot.empty() ? 0 : (part_.cells + kBlock - 1) / kBlock);
        if (lot.empty()) return;
        SharedCells shared;
        shared.give(std::move(lot));
        std::vector<std::vector<Amount>> drawn(static_cast<std::size_t>(std::max(1, threads)));
        parallel_for(threads, drawn.size(), [&](std::size_t thread) {
            drawn[thread].resize(blocks_.size());
            shared.take_turns([&](Array<std::int32_t>& cells) {
                follow(cells, drawn.size() == 1 ? nullptr : &shared, drawn[thread]);
            });
        });
        for (const auto& by_thread : drawn) {
            for (std::size_t block = 0; block < blocks_.size(); ++block) blocks_[block] += by_thread[block];
        }
    }

    std::size_t seeds() const { return seeds_; }
    const std::vector<Amount>& blocks() const { return blocks_; }

    // The cells of a block that the walk has visited, ascending.
    template <class Visit>
    void for_each_visited(std::size_t block, const Visit& visit) const {
        const std::size_t end = std::min(visited_.size(), (block + 1) * kBlock / kWord);
        for (std::size_t word = block * kBlock / kWord; word < end; ++word) {
            for (std::uint64_t left = visited_[word].load(std::memory_order_relaxed); left != 0; left &= left - 1) {
                visit(static_cast<std::int32_t>(kWord * word + static_cast<std::size_t>(std::countr_zero(left))));
            }
        }
    }

    const std::int32_t* record(std::int32_t cell) const {
        return part_.records + kRecord<Cell> * static_cast<std::size_t>(cell);
    }

    mesh::Mask signs(const std::int32_t* corners) const {
        mesh::Mask signs = 0;
        for (std::size_t n = 0; n < Cell::kCorners; ++n) signs |= mesh::Mask{inside_(field_.value(corners[n]))} << n;
        return signs;
    }

    // The crossed edges whose vertices this cell numbers.
    static mesh::Mask owned(const std::int32_t* corners, mesh::Mask signs) {
        const std::int32_t* edges = corners + Cell::kCorners + Cell::kFaces;
        mesh::Mask owned = 0;
        for (std::size_t n = 0; n < Cell::kEdges; ++n) owned |= mesh::Mask{edges[n] < 0} << n;
        return owned & mesh::kCrossedEdges<Cell>[signs];
    }

    const auto& drawn(const std::int32_t* corners, mesh::Mask signs) const {
        return mesh::drawn(
            Cell{}, signs, [&](std::size_t corner) { return static_cast<double>(field_.value(corners[corner])); },
            isovalue_);
    }

    void prefetch_record(std::int32_t cell) const {
        ISOCORE_PREFETCH(record(cell));
        ISOCORE_PREFETCH(record(cell) + kRecord<Cell> - 1);
    }
    void prefetch_values(std::int32_t cell) const {
        for (std::size_t n = 0; n < Cell::kCorners; ++n) ISOCORE_PREFETCH(field_.values + record(cell)[n]);
    }

  private:
    static constexpr std::size_t kRecordsAhead = 16, kValuesAhead = 8, kWorthSharing = 64;

    // Walks from the cells of a lot; breadth first, so that it is known well ahead which records will be needed.
    void follow(Array<std::int32_t>& cells, SharedCells* shared, std::vector<Amount>& drawn_by_block) {
        for (std::size_t head = 0; head < cells.size(); ++head) {
            if (head + kRecordsAhead < cells.size()) prefetch_record(cells[head + kRecordsAhead]);
            if (head + kValuesAhead < cells.size()) prefetch_values(cells[head + kValuesAhead]);
            step(cells[head], cells, shared == nullptr, drawn_by_block);
            if (shared == nullptr || cells.size() - head < kWorthSharing || !shared->wanted()) continue;
            const auto half = cells.end() - static_cast<std::ptrdiff_t>((cells.size() - head) / 2);
            shared->give({half, cells.end()});
            cells.erase(half, cells.end());
        }
    }

    void step(std::int32_t cell, Array<std::int32_t>& found, bool alone, std::vector<Amount>& drawn_by_block) {
        const std::int32_t *corners = record(cell), *twins = corners + Cell::kCorners;
        const mesh::Mask mask = signs(corners);
        const auto& triangles = drawn(corners, mask);
        drawn_by_block[static_cast<std::size_t>(cell) / kBlock] +=
            {1, static_cast<std::size_t>(std::popcount(owned(corners, mask))), triangles.middles, triangles.triangles};
        // Which neighbours are new is unpredictable: one branch for all of them is mispredicted less often than one
        // each.
        std::array<std::int32_t, Cell::kFaces> next;
        mesh::Mask fresh = 0;
        for (std::size_t n = 0; n < Cell::kFaces; ++n) {
            const bool crossed = (mesh::kCrossedFaces<Cell>[mask] >> n & 1) & (twins[n] >= 0);
            next[n] = crossed ? twins[n] / static_cast<std::int32_t>(Cell::kFaces) : cell;
            fresh |= mesh::Mask{!visited(next[n])} << n;
        }
        for (; fresh != 0; fresh &= fresh - 1) {
            const std::int32_t neighbour = next[static_cast<std::size_t>(std::countr_zero(fresh))];
            if (mark(neighbour, alone)) found.push_back(neighbour);
        }
    }

    bool visited(std::int32_t cell) const {
        return visited_[static_cast<std::size_t>(cell) / kWord].load(std::memory_order_relaxed) >>
                   static_cast<std::size_t>(cell) % kWord &
               1;
    }

    // Marks a cell as visited; returns whether it was not. Without other threads no atomic exchange is needed.
    bool mark(std::int32_t cell, bool alone) {
        std::atomic<std::uint64_t>& word = visited_[static_cast<std::size_t>(cell) / kWord];
        const std::uint64_t bit = std::uint64_t{1} << static_cast<std::size_t>(cell) % kWord,
                            before = word.load(std::memory_order_relaxed);
        if (before & bit) return false;
        if (!alone) return !(word.fetch_or(bit, std::memory_order_relaxed) & bit);
        word.store(before | bit, std::memory_order_relaxed);
        return true;
    }

    const mesh::Field<Value>& field_;
    const PartView& part_;
    double isovalue_;
    Inside<Value> inside_;
    std::vector<std::atomic<std::uint64_t>> visited_;
    std::vector<Amount> blocks_;
    std::size_t seeds_ = 0;
};

}  // namespace isocore::thinning
