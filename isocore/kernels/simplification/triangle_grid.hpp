// triangle_grid.hpp - Which triangles of the mesh touch a cube of two cells by two by two: a list for each cube, kept
// up to date while triangles change.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "common/array.hpp"
#include "common/prefetch.hpp"
#include "simplification/cells.hpp"
#include "simplification/cubes.hpp"
#include "simplification/mesh.hpp"

namespace isocore::simplification {

class TriangleGrid {
  public:
    // Covers no cells yet. rounding: as Cubes has it.
    explicit TriangleGrid(double rounding);
    // Forgets all triangles, and covers the cells from `low` to `high` of these, both included.
    void cover(const Cells& cells, const Cell& low, const Cell& high);
    const Cubes& cubes() const { return cubes_; }

    // Appends the cubes that a triangle of the mesh touches.
    template <class Real>
    void cubes_of(const Mesh<Real>& mesh, std::int32_t triangle, std::vector<std::int32_t>& out) const;

    template <class Real>
    void enter(const Mesh<Real>& mesh, std::int32_t triangle);
    void remove(std::int32_t triangle, const std::vector<std::int32_t>& cubes);
    // Takes a triangle from the cubes that it touched to those that it touches now, both as cubes_of() found them.
    void move(std::int32_t triangle, std::span<const std::int32_t> from, std::span<const std::int32_t> to);

    // visit(triangles) of some triangles of a cube at a time, until all were there; kNone may follow the last.
    static constexpr std::size_t kAtOnce = 7;
    template <class Visit>
    void each_in(std::int32_t cube, const Visit& visit) const {
        for (std::int32_t b = first_[static_cast<std::size_t>(cube)]; b != kNone; b = block(b).next)
            visit(block(b).triangles);
    }
    // Asks for a cube's list ahead of its use.
    void fetch(std::int32_t cube) const {
        const std::int32_t b = first_[static_cast<std::size_t>(cube)];
        if (b != kNone) ISOCORE_PREFETCH(&block(b));
    }

  private:
    // A part of a list. The first of a list may have room left, at its end; the others are full.
    struct Block {
        std::array<std::int32_t, kAtOnce> triangles;
        std::int32_t next;
    };
    static constexpr int kChunkBits = 10;

    Block& block(std::int32_t number) const {
        return chunks_[static_cast<std::size_t>(number >> kChunkBits)][number & ((1 << kChunkBits) - 1)];
    }
    std::int32_t take_block();
    void enter_in(std::int32_t triangle, std::int32_t& first);
    void remove_from(std::int32_t triangle, std::int32_t& first);

    double rounding_;
    Cubes cubes_;
    std::vector<std::int32_t> touched_;
    Array<std::int32_t> first_;              // block of each cube
    std::int32_t spare_ = kNone, used_ = 0;  // the first block that was given back; how many were ever taken
    std::vector<std::unique_ptr<Block[]>> chunks_;
};

}  // namespace isocore::simplification
