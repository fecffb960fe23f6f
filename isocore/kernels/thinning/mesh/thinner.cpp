// thinner.cpp - T. Itoh, Y. Yamaguchi, K. Koyamada, "Volume Thinning for Automatic Isosurface Propagation", IEEE
// Visualization 1996; "Fast Isosurface Generation Using the Volume Thinning Algorithm", IEEE TVCG 7(1), 2001.
//
// The paper's rules for its classes C1 to C4 are replaced by one that is both safer and thinner (safe_rule.hpp;
// README.md says where we depart). Cells go block by block first, on several threads: those that touch no other
// block's, around a void that is opened in its midst. What remains, the rims of blocks, goes as rims within larger
// blocks.
#include "thinning/mesh/thinner.hpp"

#include <algorithm>
#include <bit>
#include <optional>
#include <utility>
#include <vector>

#include "common/parallel.hpp"
#include "thinning/mesh/extrema.hpp"
#include "thinning/mesh/outsides.hpp"
#include "thinning/mesh/remaining.hpp"

namespace isocore::thinning {
namespace {

using std::int32_t;
using std::size_t;

template <class Cell>
class Thinner {
  public:
    Thinner(const Gluing<Cell>& gluing, const Array<double>& heights, Work work)
        : gluing_(gluing),
          left_(gluing),
          outsides_(gluing),
          blocks_(gluing, heights.size(), cells_per_block(gluing.cells, work)),
          threads_(work.threads) {
        extrema_ = count_cells(gluing, heights, blocks_, left_, work.threads);
    }

    Skeleton run() {
        std::vector<Array<int32_t>> waiting(blocks_.size());
        for (const int32_t place : gluing_.boundary) {
            const auto cell = static_cast<size_t>(place) / Cell::kFaces;
            left_.queue(static_cast<int32_t>(cell), waiting[blocks_.of(cell)]);
        }
        const size_t voids = outsides_.add(blocks_.size());
        // Meanwhile, as no block asks for it, the pieces of the boundary are joined.
        parallel_for(threads_, blocks_.size() + 1, [&](size_t task) {
            if (task == 0) return outsides_.join_boundary();
            const size_t block = task - 1;
            thin_block(0, waiting[block], [&](Array<int32_t>& found) { open_block(block, voids + block, found); });
        });
        for (unsigned level = 1; waiting.size() > 1; ++level) {
            std::vector<Array<int32_t>> joined(blocks_.size(level));
            for (size_t block = 0; block < waiting.size(); ++block) {
                Array<int32_t>& here = joined[Blocks<Cell>::parent(block, 1)];
                here.insert(here.end(), waiting[block].begin(), waiting[block].end());
            }
            waiting.swap(joined);
            parallel_for(threads_, waiting.size(),
                         [&](size_t block) { thin_block(level, waiting[block], [](Array<int32_t>&) {}); });
        }
        for (size_t cell = 0; cell < gluing_.cells; ++cell) {
            if (left_.remains(cell)) remaining_.push_back(static_cast<int32_t>(cell));
        }
        while (prick() || tunnel()) continue;
        return collect();
    }

  private:
    // As few blocks as occupy the threads of a common machine: the fewer, the fewer cells lie in rims, and those take
    // twice as long.
    static size_t cells_per_block(size_t cells, Work work) {
        constexpr size_t kBlocks = 16, kLeast = size_t{1} << 17;
        return work.cells_per_block > 0 ? work.cells_per_block : std::max(cells / kBlocks, kLeast);
    }

    static constexpr size_t kRecordsAhead = 12, kNamedAhead = 6;

    // The outside behind a face, or -1 where a cell remains. While blocks are thinned, outsides that are one by now may
    // still have several names.
    int32_t outside(size_t cell, size_t face) {
        const int32_t twin = left_.record(cell)[Cell::kCorners + face];
        if (twin < 0) return -1 - twin;
        const size_t across = static_cast<size_t>(twin) / Cell::kFaces;
        return left_.remains(across) ? -1 : left_.outside_at(across);
    }

    int32_t any_outside(size_t cell, const Used& used) {
        return outside(cell, static_cast<size_t>(std::countr_one(used.faces)));
    }

    // Peels off the cells of a queue whose removal changes nothing but the size of what remains, and those whose
    // boundary comes free by that. Cells that may not go yet are kept for later, and still count as queued.
    template <class MayGo>
    void remove_simple(Array<int32_t>& waiting, const MayGo& may_go, Array<int32_t>* later = nullptr) {
        for (size_t head = 0; head < waiting.size(); ++head) {
            if (head + kRecordsAhead < waiting.size()) left_.prefetch_record(waiting[head + kRecordsAhead]);
            if (head + kNamedAhead < waiting.size()) left_.prefetch_named(waiting[head + kNamedAhead]);
            const auto cell = static_cast<size_t>(waiting[head]);
            if (!may_go(cell)) {
                later->push_back(waiting[head]);
                continue;
            }
            left_.unqueue(cell);
            if (!left_.remains(cell)) continue;
            const Used used = left_.used(cell);
            if (used.euler() == 1 && left_.is_safe(cell, used)) {
                left_.remove(cell, used, any_outside(cell, used), waiting);
            }
        }
        waiting.clear();
    }
    void remove_simple(Array<int32_t>& waiting) {
        remove_simple(waiting, [](size_t) { return true; });
    }

    // The cells within a block, from those that wait inwards; open(found) may find some where none do. What waits in
    // the end are cells that other blocks touch.
    template <class Open>
    void thin_block(unsigned level, Array<int32_t>& waiting, const Open& open) {
        const auto within = [&](size_t cell) { return blocks_.within(left_.record(cell), level); };
        Array<int32_t> now, later;
        for (const int32_t cell : waiting) (within(static_cast<size_t>(cell)) ? now : later).push_back(cell);
        if (now.empty()) open(now);
        remove_simple(now, within, &later);
        waiting.swap(later);
    }

    // Opens a void in the midst of a block that no boundary reaches.
    void open_block(size_t block, size_t new_void, Array<int32_t>& waiting) {
        const size_t first = blocks_.first_cell(block), size = blocks_.first_cell(block + 1) - first;
        for (size_t n = 0; n < size; ++n) {
            const size_t cell = first + (n + size / 2) % size;
            if (left_.loose(cell) || !blocks_.within(left_.record(cell), 0)) continue;
            return left_.remove(cell, left_.used(cell), static_cast<int32_t>(new_void), waiting);
        }
    }

    // Opens voids: removes a cell whose free pieces lie at as many different outsides, so that no tunnel is dug.
    bool prick() {
        bool any = false;
        std::erase_if(remaining_, [&](int32_t cell) { return !left_.remains(static_cast<size_t>(cell)); });
        for (const int32_t each : remaining_) {
            const auto cell = static_cast<size_t>(each);
            if (!left_.remains(cell) || left_.loose(cell)) continue;
            const Used used = left_.used(cell);
            const int pieces = 2 - used.euler();
            if (pieces < 2 || !left_.is_safe(cell, used) || join_outsides(cell, false) != static_cast<size_t>(pieces))
                continue;
            open(cell, used);
            any = true;
        }
        return any;
    }

    void open(size_t cell, const Used& used) {
        join_outsides(cell, true);
        left_.remove(cell, used, any_outside(cell, used), waiting_);
        remove_simple(waiting_);
    }

    // How many outsides a cell's faces lie at; makes them one, if wanted.
    size_t join_outsides(size_t cell, bool wanted) {
        std::array<int32_t, Cell::kFaces> seen;
        size_t count = 0;
        for (size_t face = 0; face < Cell::kFaces; ++face) {
            const int32_t name = outside(cell, face);
            if (name < 0) continue;
            const int32_t found = outsides_.find(name);
            if (std::find(seen.begin(), seen.begin() + count, found) == seen.begin() + count) seen[count++] = found;
        }
        for (size_t n = 1; wanted && n < count; ++n) outsides_.unite(seen[0], seen[n]);
        return count;
    }

    // Where no single cell reaches both sides: the outsides grow into what remains, and where two of them meet the
    // cells on the way are removed from one side to the other, as far as each step is safe.
    bool tunnel() {
        std::erase_if(remaining_, [&](int32_t cell) { return !left_.remains(static_cast<size_t>(cell)); });
        Growth growth(gluing_.cells);
        std::vector<size_t> open_cells;
        for (const int32_t each : remaining_) {
            const auto cell = static_cast<size_t>(each);
            for (size_t face = 0; growth.owner(cell) < 0 && face < Cell::kFaces; ++face) {
                const int32_t name = outside(cell, face);
                if (name < 0) continue;
                growth.reach(cell, -1, name);
                open_cells.push_back(cell);
            }
        }
        for (size_t head = 0; head < open_cells.size(); ++head) {
            const size_t cell = open_cells[head];
            for (size_t face = 0; left_.remains(cell) && face < Cell::kFaces; ++face) {
                const int32_t across = neighbour<Cell>(left_.record(cell), face);
                if (across < 0 || !left_.remains(static_cast<size_t>(across))) continue;
                const auto other = static_cast<size_t>(across);
                if (growth.owner(other) < 0) {
                    growth.reach(other, static_cast<int32_t>(cell), growth.owner(cell));
                    open_cells.push_back(other);
                } else if (outsides_.find(growth.owner(other)) != outsides_.find(growth.owner(cell)) &&
                           open_path(growth.path(cell, other))) {
                    return true;
                }
            }
        }
        return false;
    }

    bool open_path(const std::vector<size_t>& path) {
        for (const size_t cell : path) {
            if (!left_.remains(cell) || left_.loose(cell)) return false;
            const Used used = left_.used(cell);
            if (!left_.is_safe(cell, used)) return false;
            join_outsides(cell, true);
            left_.remove(cell, used, any_outside(cell, used), waiting_);
        }
        remove_simple(waiting_);
        return true;
    }

    Skeleton collect() {
        Skeleton skeleton;
        skeleton.extrema = extrema_;
        for (const int32_t cell : remaining_) {
            if (left_.remains(static_cast<size_t>(cell))) skeleton.cells.push_back(cell);
        }
        return skeleton;
    }

    const Gluing<Cell>& gluing_;
    Remaining<Cell> left_;
    Outsides<Cell> outsides_;
    Blocks<Cell> blocks_;
    int threads_;
    Array<int32_t> waiting_;
    std::vector<int32_t> remaining_;  // those that remained when this was last looked at
    size_t extrema_ = 0;
};

}  // namespace

template <class Cell>
Skeleton thin(const Gluing<Cell>& gluing, const Array<double>& heights, Work work) {
    return Thinner<Cell>(gluing, heights, work).run();
}

template <class Cell>
std::array<size_t, 7> classes_of(const Gluing<Cell>& gluing, const Array<int32_t>& skeleton) {
    std::array<size_t, 7> classes{};
    for (const int32_t cell : skeleton) {
        size_t beside = 0;
        for (size_t face = 0; face < Cell::kFaces; ++face) {
            const int32_t across = neighbour<Cell>(gluing.record(static_cast<size_t>(cell)), face);
            beside += across >= 0 && std::binary_search(skeleton.begin(), skeleton.end(), across);
        }
        ++classes[beside];
    }
    return classes;
}

template Skeleton thin<mesh::Tet>(const Gluing<mesh::Tet>&, const Array<double>&, Work);
template Skeleton thin<mesh::Hex>(const Gluing<mesh::Hex>&, const Array<double>&, Work);
template std::array<size_t, 7> classes_of<mesh::Tet>(const Gluing<mesh::Tet>&, const Array<int32_t>&);
template std::array<size_t, 7> classes_of<mesh::Hex>(const Gluing<mesh::Hex>&, const Array<int32_t>&);

}  // namespace isocore::thinning
