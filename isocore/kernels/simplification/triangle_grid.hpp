// triangle_grid.hpp - Which triangles of the mesh touch a cube of two cells by two by two: a list for each cube, kept
// up to date while triangles change. Threads may change the lists of different cubes at the same time.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "common/array.hpp"
#include "common/prefetch.hpp"
#include "simplification/cells.hpp"
#include "simplification/mesh.hpp"

namespace isocore::simplification {

class TriangleGrid {
  public:
    static constexpr int kBits = 1;  // a cube is this power of two of cells wide

    // A thread's own blocks: those it may use next.
    struct Spare {
        std::int32_t first = kNone;
    };

    // rounding: how far writing moves a corner along each axis, in coordinates; a triangle touches what it then may.
    TriangleGrid(const Cells& cells, double rounding);
    // Forgets all triangles, and covers other cells of the same size. What lies outside of them counts to the nearest.
    void cover(const Cells& cells);

    // Appends the cubes that a triangle touches, by number, and perhaps a few that it nearly does. The same for the
    // same places.
    template <class Real>
    void cubes_of(std::array<const std::array<Real, 3>*, 3> corners, std::vector<std::int32_t>& out) const;
    template <class Real>
    void cubes_of(const Mesh<Real>& mesh, std::int32_t triangle, std::vector<std::int32_t>& out) const;

    void enter(std::int32_t triangle, std::span<const std::int32_t> cubes, Spare& spare);
    void remove(std::int32_t triangle, const std::vector<std::int32_t>& cubes, Spare& spare);
    // Takes a triangle from the cubes that it touched to those that it touches now, both as cubes_of() found them.
    void move(std::int32_t triangle, std::span<const std::int32_t> from, std::span<const std::int32_t> to,
              Spare& spare);

    // visit(triangle) of each triangle of a cube.
    template <class Visit>
    void each_in(std::int32_t cube, const Visit& visit) const {
        for (std::int32_t b = first_[static_cast<std::size_t>(cube)]; b != kNone; b = block(b).next) {
            for (const std::int32_t triangle : block(b).triangles) {
                if (triangle != kNone) visit(triangle);
            }
        }
    }
    // Asks for a cube's list ahead of its use.
    void fetch(std::int32_t cube) const {
        const std::int32_t b = first_[static_cast<std::size_t>(cube)];
        if (b != kNone) ISOCORE_PREFETCH(&block(b));
    }
    // The cube of a cell, and the number of a cube.
    std::int32_t number(const Cell& cube) const {
        return static_cast<std::int32_t>(
            static_cast<std::size_t>(cube[0]) +
            dims_[0] * (static_cast<std::size_t>(cube[1]) + dims_[1] * static_cast<std::size_t>(cube[2])));
    }
    std::size_t cube_count() const { return first_.size(); }
    const Cells& cells() const { return cells_; }

  private:
    // A part of a list. The first of a list may have room left, at its end; the others are full.
    struct Block {
        std::array<std::int32_t, 7> triangles;
        std::int32_t next;
    };
    static constexpr int kChunkBits = 12;
    static constexpr std::size_t kMostChunks = std::size_t{1} << 19;

    Block& block(std::int32_t number) const {
        return chunks_[static_cast<std::size_t>(number >> kChunkBits)][number & ((1 << kChunkBits) - 1)];
    }
    void add_chunk(Spare& spare);
    void enter(std::int32_t triangle, std::int32_t& first, Spare& spare);
    void remove(std::int32_t triangle, std::int32_t& first, Spare& spare);

    Cells cells_;
    double rounding_;                  // in cells
    std::array<std::size_t, 3> dims_;  // in cubes
    Array<std::int32_t> first_;        // block of each cube
    std::mutex guard_;                 // of chunks_
    std::vector<std::unique_ptr<Block[]>> chunks_;
};

}  // namespace isocore::simplification
