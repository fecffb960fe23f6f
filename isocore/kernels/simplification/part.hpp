// part.hpp - What of a mesh lies in a box of cells: its vertices there, and all triangles that touch one of them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "simplification/reference.hpp"

namespace isocore::simplification {

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

    bool is_own(std::int32_t vertex) const {
        return static_cast<std::size_t>(vertex) - first_own < end_own - first_own;
    }
};

template <class Real>
class PartFinder {
  public:
    // Of the mesh that the reference is.
    explicit PartFinder(const Reference<Real>& reference) : reference_(reference) {}

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

    const Reference<Real>& reference_;
    std::vector<std::int32_t> candidates_;  // triangles
    std::vector<Vertex> met_;
    std::vector<std::int32_t> table_;  // by a hash of the vertex: as which it was met, or kNone
    std::vector<std::int32_t> numbers_, next_;
    std::vector<std::array<std::int32_t, 3>> corners_;
};

}  // namespace isocore::simplification
