// types.hpp - What simplification is asked for (Options), and what it gives (Simplified).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "common/affine.hpp"
#include "common/array.hpp"
#include "common/narrow_array.hpp"

namespace isocore::simplification {

inline constexpr std::int32_t kNone = -1;  // instead of the number of a vertex or of a triangle

struct Options {
    // How far the reference's vertices may lie from the surface, and the surface's points from the reference. The unit
    // is that of stretched coordinates.
    double max_error = 0;
    std::array<double, 3> stretch{1, 1, 1};  // from coordinates to the unit in which distances are measured
    // The side of a cell, in coordinates: about as long as the sides of the reference's triangles. Stretched cells are
    // about 1 wide.
    double cell = 1;
    std::array<double, 3> other{1, 1, 1};  // from coordinates to another unit, in which the error is measured besides
    // If not 0: stop when there are no more triangles than these. Smaller bounds are exhausted before larger ones.
    std::size_t most_triangles = 0;
    Writing writing;  // triangles meet or not as they do once they are written so
    int threads = 1;
    bool together = false;  // the first phase has one mesh, instead of one for each box: the result is the same
};

// Why an edge was not contracted; README.md has the rules.
enum class Rule : std::uint8_t { link, shape, outward, back, crossing };
inline constexpr std::size_t kRules = 5;

// Distances from the reference's vertices to the surface: the largest, their sum, and the sum of their squares.
struct Deviation {
    double max = 0, sum = 0, squares = 0;

    void add(const Deviation& other) {
        max = std::max(max, other.max);
        sum += other.sum;
        squares += other.squares;
    }
};

// What is said of one sheet.
struct SheetFacts {
    std::array<std::size_t, kRules> refused{};  // by Rule: edges inside it, and edges of curves that it did not allow
    std::size_t unproved = 0;
    Deviation error, other;
    double back_max = 0;
};

struct Facts {
    std::size_t collapses = 0;
    std::array<std::size_t, kRules> refused{};  // by Rule
    std::size_t unproved = 0;                   // triangles of which it is not known that they keep the bound
    Deviation error, other;                     // stretched, and in the other unit
    double back_max =
        0;  // no point of the surface, but for those triangles, lies further from the reference, stretched
    std::vector<SheetFacts> sheets;  // none where the surface is not made of sheets
};

template <class Real>
struct Simplified {
    Array<Real> vertices;           // x, y, z of each
    Array<std::int32_t> triangles;  // three vertex numbers each
    Array<std::int32_t> kept;       // of each vertex: its number in the input
    Array<std::int32_t> left;       // of each triangle: its number in the input
    Facts facts;
};

// Vertices, x, y, z of each, and triangles, three vertex numbers each.
//
// A mesh may be made of sheets, parts that meet in curves: then a side that no other triangle of the same sheet shares
// belongs to a curve. No two sheets turn about the same side more than once.
template <class Real>
struct MeshArrays {
    const Real* vertices;
    std::size_t vertex_count;
    const std::int32_t* triangles;
    std::size_t triangle_count;
    const NarrowArray* sheets = nullptr;  // of each triangle: the number of its sheet
    std::size_t sheet_count = 0;

    bool is_same(const MeshArrays& other) const { return vertices == other.vertices && triangles == other.triangles; }
    std::array<Real, 3> place(std::int32_t vertex) const {
        const Real* const at = vertices + 3 * static_cast<std::size_t>(vertex);
        return {at[0], at[1], at[2]};
    }
};

}  // namespace isocore::simplification
