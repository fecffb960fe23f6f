// remaining.hpp - The cells that thinning has left so far, what touches them, and the removal of one. Every point keeps
// the count of the remaining cells at it and the XOR of their ids: when the count drops to one, the XOR is the
// survivor, whose boundary has just come free. Edges keep nothing: most of a cell's edges are those of faces that are
// used, and around the few others one can walk.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/large_pages.hpp"
#include "common/prefetch.hpp"
#include "thinning/mesh/gluing.hpp"
#include "thinning/safe_rule.hpp"

namespace isocore::thinning {

enum : std::uint8_t { kHasLower = 1, kHasHigher = 2 };

struct Touching {
    std::uint32_t marks : 2 = 0;  // which neighbours the point has in the whole mesh
    std::uint32_t count : 30 = 0;
    std::int32_t survivor = 0;  // the XOR of the remaining cells' ids

    bool extremum() const { return marks != (kHasLower | kHasHigher); }
};

template <class Cell>
class Remaining {
  public:
    explicit Remaining(const Gluing<Cell>& gluing)
        : gluing_(gluing), outside_at_(large_array<std::int32_t>(gluing.cells)) {
        state_.reserve(gluing.cells);
        ask_for_large_pages(state_);
        state_.resize(gluing.cells);
        for (const std::int32_t cell : gluing.collapsed) state_[static_cast<std::size_t>(cell)] = kLoose;
    }

    bool remains(std::size_t cell) const { return !(state_[cell] & kRemoved); }
    bool loose(std::size_t cell) const { return state_[cell] & kLoose; }
    const std::int32_t* record(std::size_t cell) const { return gluing_.record(cell); }
    Touching& at(std::int32_t point) { return points_[static_cast<std::size_t>(point)]; }
    std::vector<Touching>& points() { return points_; }
    std::int32_t& outside_at(std::size_t cell) { return outside_at_[cell]; }

    // The cell's number in a queue, where it does not wait already and is not gone.
    void queue(std::int32_t cell, Array<std::int32_t>& waiting) {
        std::uint8_t& state = state_[static_cast<std::size_t>(cell)];
        if (state != 0) return;
        state = kQueued;
        waiting.push_back(cell);
    }
    void unqueue(std::size_t cell) { state_[cell] &= static_cast<std::uint8_t>(~kQueued); }

    // Of a cell that will be looked at soon: its record, or, when that is there, what it names.
    void prefetch_record(std::int32_t cell) const { ISOCORE_PREFETCH(record(static_cast<std::size_t>(cell))); }
    void prefetch_named(std::int32_t cell) const {
        const std::int32_t* mine = record(static_cast<std::size_t>(cell));
        for (std::size_t n = 0; n < Cell::kFaces; ++n) {
            const std::int32_t across = neighbour<Cell>(mine, n);
            if (across < 0) continue;
            ISOCORE_PREFETCH(&state_[static_cast<std::size_t>(across)]);
            prefetch_record(across);
        }
    }

    Mask used_faces(std::size_t cell) const {
        const std::int32_t* mine = record(cell);
        Mask faces = 0;
        for (std::size_t n = 0; n < Cell::kFaces; ++n) {
            const std::int32_t across = neighbour<Cell>(mine, n);
            faces |= Mask{across >= 0 && remains(static_cast<std::size_t>(across))} << n;
        }
        return faces;
    }

    // The part of a cell's boundary that other remaining cells use.
    Used used(std::size_t cell) const {
        Used out;
        out.faces = used_faces(cell);
        Mask edges = kClosure<Cell>[out.faces].edges, corners = kClosure<Cell>[out.faces].corners;
        const std::int32_t* mine = record(cell);
        for (Mask left = ~corners & kAllCorners; left != 0; left &= left - 1) {
            const auto corner = static_cast<std::size_t>(std::countr_zero(left));
            corners |= Mask{points_[static_cast<std::size_t>(mine[corner])].count > 1} << corner;
        }
        for (Mask left = ~edges & kAllEdges; left != 0; left &= left - 1) {
            const auto edge = static_cast<std::size_t>(std::countr_zero(left));
            const auto& ends = Cell::kShape.ends[edge];
            if (!(corners >> ends[0] & corners >> ends[1] & 1)) continue;
            edges |= Mask{is_used(cell, edge)} << edge;
        }
        out.edges = edges;
        out.corners = corners;
        return out;
    }

    // Would its removal be safe, and leave every extremum in a remaining cell?
    bool is_safe(std::size_t cell, const Used& used) const {
        for (Mask left = ~used.corners & kAllCorners; left != 0; left &= left - 1) {
            if (points_[static_cast<std::size_t>(record(cell)[std::countr_zero(left)])].extremum()) return false;
        }
        return is_connected(Cell{}, used);
    }

    // Queues the cells whose boundary comes free. outside: what the cell becomes part of.
    void remove(std::size_t cell, const Used& used, std::int32_t outside, Array<std::int32_t>& waiting) {
        const std::int32_t* mine = record(cell);
        state_[cell] |= kRemoved;
        outside_at_[cell] = outside;
        queue_beside(cell, used.faces, waiting);
        for (Mask edges = used.edges & ~Mask{kClosure<Cell>[used.faces].edges}; edges != 0; edges &= edges - 1) {
            const auto edge = static_cast<std::size_t>(std::countr_zero(edges));
            std::int32_t last = -1;
            if (around(cell, edge, 2, &last) == 1) queue(last, waiting);
        }
        for (std::size_t n = 0; n < Cell::kCorners; ++n) {
            Touching& touching = at(mine[n]);
            touching.survivor ^= static_cast<std::int32_t>(cell);
            if (--touching.count == 1) queue(touching.survivor, waiting);
        }
    }

    // Does another remaining cell touch the edge? Asked for in both directions at once, which need not wait for each
    // other's memory: most edges are not used, and then all cells around them are looked at.
    bool is_used(std::size_t cell, std::size_t edge) const {
        const auto& faces = kFacesAtEdge<Cell>[edge];
        const std::int32_t* records = gluing_.records.data();
        EdgeWalk<Cell> one(records, cell, edge, faces[0]), other(records, cell, edge, faces[1]);
        for (bool left = true, right = true; left || right;) {
            left = left && one.step();
            if (left && one.cell() == other.cell()) return false;
            if (left && remains(one.cell())) return true;
            right = right && other.step();
            if (right && one.cell() == other.cell()) return false;
            if (right && remains(other.cell())) return true;
        }
        return false;
    }

    // The other remaining cells around an edge, counted up to `most`; the last of them, where it is asked for.
    std::size_t around(std::size_t cell, std::size_t edge, std::size_t most, std::int32_t* last = nullptr) const {
        std::size_t count = 0;
        const auto visit = [&](std::size_t other) {
            if (!remains(other)) return false;
            if (last) *last = static_cast<std::int32_t>(other);
            return ++count == most;
        };
        const auto& faces = kFacesAtEdge<Cell>[edge];
        const std::int32_t* records = gluing_.records.data();
        const std::int32_t left = walk_around<Cell>(records, cell, edge, faces[0], visit);
        if (left >= 0) walk_around<Cell>(records, cell, edge, faces[1], visit);
        return count;
    }

  private:
    // Queues the cells across these faces, as queue does: which of them wait already is unpredictable, so there is no
    // branch on it. A cell that is not there stands for the one that is gone, which nothing is done to.
    void queue_beside(std::size_t cell, Mask faces, Array<std::int32_t>& waiting) {
        const std::int32_t* mine = record(cell);
        std::size_t count = waiting.size();
        waiting.resize(count + Cell::kFaces);
        for (std::size_t n = 0; n < Cell::kFaces; ++n) {
            const bool there = faces >> n & 1;
            const std::int32_t across = there ? neighbour<Cell>(mine, n) : static_cast<std::int32_t>(cell);
            std::uint8_t& state = state_[static_cast<std::size_t>(across)];
            const bool fresh = state == 0;
            state = fresh ? std::uint8_t{kQueued} : state;
            waiting[count] = across;
            count += fresh;
        }
        waiting.resize(count);
    }

    enum : std::uint8_t { kRemoved = 1, kQueued = 2, kLoose = 4 };
    static constexpr Mask kAllCorners = (Mask{1} << Cell::kCorners) - 1, kAllEdges = (Mask{1} << Cell::kEdges) - 1;

    const Gluing<Cell>& gluing_;
    std::vector<Touching> points_;
    std::vector<std::uint8_t> state_;
    Array<std::int32_t> outside_at_;  // of removed cells: which outside they belong to
};

}  // namespace isocore::thinning
