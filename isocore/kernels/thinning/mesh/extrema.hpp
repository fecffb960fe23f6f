// extrema.hpp - The first look at all cells: blocks of them that threads can thin apart, how many cells touch each
// point, and which points are extrema.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/parallel.hpp"
#include "thinning/mesh/remaining.hpp"

namespace isocore::thinning {

// Blocks of cells that follow one another, and of their lowest points. On every level, each four blocks of the level
// below are one, up to the level that has a single block. A cell lies within its block if no other block's cell touches
// any of its points.
template <class Cell>
class Blocks {
  public:
    // cells: how many each block has on the lowest level, about.
    Blocks(const Gluing<Cell>& gluing, std::size_t points, std::size_t cells)
        : first_cell_{0}, first_point_{0}, apart_(points) {
        const auto lowest = [&](std::size_t cell) {
            return *std::min_element(gluing.record(cell), gluing.record(cell) + Cell::kCorners);
        };
        for (std::size_t cell = cells; cell + cells / 2 < gluing.cells; cell += cells) {
            cell = std::max(cell, first_cell_.back() + 1);
            while (cell < gluing.cells && lowest(cell) == lowest(cell - 1)) ++cell;
            if (cell == gluing.cells) break;
            first_cell_.push_back(cell);
            first_point_.push_back(lowest(cell));
        }
        first_cell_.push_back(gluing.cells);
        first_point_.push_back(static_cast<std::int32_t>(points));
    }

    std::size_t size() const { return first_cell_.size() - 1; }
    // How many blocks a level has.
    std::size_t size(unsigned level) const { return parent(size() - 1, level) + 1; }
    static std::size_t parent(std::size_t block, unsigned level) { return block >> 2 * level; }

    std::size_t first_cell(std::size_t block) const { return first_cell_[block]; }
    std::size_t of(std::size_t cell) const {
        return static_cast<std::size_t>(std::upper_bound(first_cell_.begin() + 1, first_cell_.end() - 1, cell) -
                                        first_cell_.begin() - 1);
    }
    bool has(std::size_t block, std::int32_t point) const {
        return point >= first_point_[block] && point < first_point_[block + 1];
    }

    // A cell of this block touches a point that lies in another's part of the points.
    void share(std::int32_t point, std::size_t block) {
        const auto owner = static_cast<std::size_t>(
            std::upper_bound(first_point_.begin() + 1, first_point_.end() - 1, point) - first_point_.begin() - 1);
        std::uint8_t& level = apart_[static_cast<std::size_t>(point)];
        while (parent(owner, level) != parent(block, level)) ++level;
    }

    bool within(const std::int32_t* corners, unsigned level) const {
        bool within = true;
        for (std::size_t n = 0; n < Cell::kCorners; ++n)
            within &= apart_[static_cast<std::size_t>(corners[n])] <= level;
        return within;
    }

  private:
    std::vector<std::size_t> first_cell_;
    std::vector<std::int32_t> first_point_;
    std::vector<std::uint8_t> apart_;  // by point: the first level on which all cells at it are of one block
};

// Which corner is the higher one: by height, then by id.
template <class Cell>
class Heights {
  public:
    Heights(const std::int32_t* points, const double* heights) : points_(points) {
        for (std::size_t n = 0; n < Cell::kCorners; ++n) height_[n] = heights[points[n]];
    }
    bool above(std::size_t a, std::size_t b) const {
        return (height_[a] > height_[b]) | ((height_[a] == height_[b]) & (points_[a] > points_[b]));
    }

  private:
    const std::int32_t* points_;
    std::array<double, Cell::kCorners> height_;
};

// Compares along the edges of cells only: a saddle inside a hexahedron is no extremum, but two corners across it may
// both be.
inline std::array<std::uint8_t, 8> marks_of(mesh::Hex, const Heights<mesh::Hex>& heights) {
    std::array<std::uint8_t, 8> marks{};
    for (const auto& [a, b] : mesh::Hex::kShape.ends) {
        const bool above = heights.above(a, b);
        marks[a] |= static_cast<std::uint8_t>(kHasHigher - above);
        marks[b] |= static_cast<std::uint8_t>(kHasLower + above);
    }
    return marks;
}

// All corners of a tetrahedron are joined by edges, so only its lowest and its highest lack something.
inline std::array<std::uint8_t, 4> marks_of(mesh::Tet, const Heights<mesh::Tet>& heights) {
    const std::size_t first = heights.above(0, 1), second = 2 + std::size_t{heights.above(2, 3)};
    const std::size_t lowest = heights.above(first, second) ? second : first;
    const std::size_t highest = heights.above(1 - first, 5 - second) ? 1 - first : 5 - second;
    std::array<std::uint8_t, 4> marks;
    marks.fill(kHasLower | kHasHigher);
    marks[lowest] = kHasHigher;
    marks[highest] = kHasLower;
    return marks;
}

// Counts the cells at every point and marks the extrema; returns how many there are. Cells that name a point twice do
// not count: they are never removed.
template <class Cell>
std::size_t count_cells(const Gluing<Cell>& gluing, const Array<double>& heights, Blocks<Cell>& blocks,
                        Remaining<Cell>& remaining, int threads) {
    struct Elsewhere {
        std::int32_t point, cell;
        std::uint8_t marks;
    };
    remaining.points().reserve(heights.size());
    ask_for_large_pages(remaining.points());
    remaining.points().resize(heights.size());
    const auto add = [&](std::int32_t point, std::int32_t cell, std::uint8_t seen) {
        Touching& touching = remaining.at(point);
        ++touching.count;
        touching.survivor ^= cell;
        touching.marks = (touching.marks | seen) & (kHasLower | kHasHigher);
    };
    std::vector<std::vector<Elsewhere>> elsewhere(blocks.size());
    parallel_for(threads, blocks.size(), [&](std::size_t block) {
        for (std::size_t cell = blocks.first_cell(block); cell < blocks.first_cell(block + 1); ++cell) {
            if (remaining.loose(cell)) continue;
            const std::int32_t* points = gluing.record(cell);
            const auto seen = marks_of(Cell{}, Heights<Cell>(points, heights.data()));
            const auto id = static_cast<std::int32_t>(cell);
            for (std::size_t n = 0; n < Cell::kCorners; ++n) {
                if (blocks.has(block, points[n]))
                    add(points[n], id, seen[n]);
                else
                    elsewhere[block].push_back({points[n], id, seen[n]});
            }
        }
    });
    for (std::size_t block = 0; block < blocks.size(); ++block) {
        for (const Elsewhere& each : elsewhere[block]) {
            add(each.point, each.cell, each.marks);
            blocks.share(each.point, block);
        }
    }
    return static_cast<std::size_t>(std::ranges::count_if(
        remaining.points(), [](const Touching& touching) { return touching.count > 0 && touching.extremum(); }));
}

}  // namespace isocore::thinning
