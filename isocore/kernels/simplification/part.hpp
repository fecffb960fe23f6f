// part.hpp - What of a mesh lies in a box of cells: its vertices there, and all triangles that touch one of them.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "simplification/cell_index.hpp"
#include "simplification/cells.hpp"
#include "simplification/types.hpp"

namespace isocore::simplification {

// A mesh, and the cells that boxes of it are made of. Its triangles are found by cells of the index, which are this
// power of two of those cells wide: by each that one of their corners lies in, or by one that is so many before it at
// most.
template <class Real>
struct IndexedMesh {
    const MeshArrays<Real>& mesh;
    const Cells& cells;
    const CellIndex& index;
    int bits;
    std::int32_t before;

    // visit(first, end) of runs of the index's entries: of all triangles with a corner whose home is in the cells from
    // `low` to `high`, both included, and perhaps of others.
    template <class Visit>
    void each_run_between(Cell low, Cell high, const Visit& visit) const {
        for (std::size_t a = 0; a < 3; ++a) {
            low[a] = std::max((low[a] >> bits) - before, 0);
            high[a] >>= bits;
        }
        index.each_run_between(low, high, visit);
    }
};

// The triangles of a mesh by the boxes that their corners lie in.
template <class Real>
CellIndex index_by_boxes(const MeshArrays<Real>& mesh, const Cells& cells);

// Numbered as they would be if the whole mesh were: of two vertices or triangles, the same one comes first.
struct Part {
    // Numbers in the whole. Those from `first_own` to `end_own` - 1 lie in the box; others are corners of triangles
    // that do in part.
    std::vector<std::int32_t> vertices;
    std::size_t first_own = 0, end_own = 0;
    std::vector<std::int32_t> triangles;               // numbers in the whole
    std::vector<std::array<std::int32_t, 3>> corners;  // numbers here
    // The lowest vertex of triangles before this one lies in another box: there they have their number. So each is
    // numbered in one of all parts.
    std::size_t first_numbered = 0;

    // Once a mesh has them, what says where they begin and end is enough.
    void forget_lists() {
        vertices = {};
        triangles = {};
        corners = {};
    }
    bool is_own(std::int32_t vertex) const {
        return static_cast<std::size_t>(vertex) - first_own < end_own - first_own;
    }
};

template <class Real>
class PartFinder {
  public:
    explicit PartFinder(const IndexedMesh<Real>& whole) : whole_(whole) {}

    // Finds what lies in the cells from `low` to `high`, both included: a brick of them, in the order of Morton.
    void find(const Cell& low, const Cell& high, Part& out);

  private:
    struct Vertex {
        std::uint64_t key;    // in the order of Morton
        std::int32_t number;  // in the whole
        std::int32_t known;   // as which it was met
        bool is_own, is_used;
    };

    void find_candidates(const Cell& low, const Cell& high);
    std::size_t meet(std::int32_t vertex, const Cell& low, const Cell& high);
    void number_vertices(Part& out);
    void sort_triangles(Part& out);

    IndexedMesh<Real> whole_;
    std::vector<std::int32_t> candidates_;  // triangles
    std::vector<Vertex> met_;
    std::vector<std::int32_t> table_;  // by a hash of the vertex: as which it was met, or kNone
    std::vector<std::int32_t> numbers_, next_;
    std::vector<std::array<std::int32_t, 3>> corners_;
};

}  // namespace isocore::simplification
