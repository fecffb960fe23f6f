// drawing.hpp - Draws a lot of visited cells, a batch at a time and each in three passes, so that none waits for
// another cell's: the crossed edges of all cells, their places in the lot's table, the triangles between these places.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "thinning/mesh/hex_pen.hpp"
#include "thinning/mesh/scratch.hpp"
#include "thinning/mesh/tet_pen.hpp"
#include "thinning/mesh/walk.hpp"

namespace isocore::thinning {

template <class Cell, class Value>
class Drawing {
  public:
    Drawing(const mesh::Field<Value>& field, double isovalue, const Walk<Cell, Value>& walk)
        : pen_(field, isovalue), walk_(walk) {}

    // Draws the visited cells from the first on, as far as the end; their edges join those of the lot, which the table
    // finds.
    void draw(std::size_t first, std::size_t end, Drawn& lot, EdgeTable& table) const {
        const std::size_t before = lot.triangles.size();
        lot.triangles.resize(before + Pen::kMostCorners * (end - first));
        std::uint32_t* out = lot.triangles.data() + before;
        Batch batch;
        for (std::size_t next; first < end; first = next) {
            next = std::min(end, first + kBatch);
            const std::size_t edges = list_edges(first, next, batch);
            table.place(batch.edges.data(), edges, batch.places.data(), lot.edges);
            out = list_triangles(first, next, batch, out, lot);
        }
        lot.triangles.resize(static_cast<std::size_t>(out - lot.triangles.data()));
    }

  private:
    using Pen = std::conditional_t<std::is_same_v<Cell, mesh::Tet>, TetPen<Value>, HexPen<Value>>;
    static constexpr std::size_t kBatch = 64, kRecordsAhead = 32;

    struct Batch {
        std::array<EdgeKey, Pen::kMostEdges * kBatch> edges;             // the crossed edges of all cells, cell by cell
        std::array<std::uint32_t, Pen::kMostEdges*(kBatch + 1)> places;  // of these among the lot's edges
    };

    // The visited cells, copied into the functions that write numbers: the pointers stay in registers then.
    struct Seen {
        explicit Seen(const Walk<Cell, Value>& walk)
            : met(walk.met()), cells(walk.cells()), signs(walk.signs()), size(walk.size()) {}
        const MetCells<Cell, Value> met;
        const std::int32_t* const cells;
        const std::uint8_t* const signs;
        const std::size_t size;
    };

    std::size_t list_edges(std::size_t first, std::size_t end, Batch& batch) const {
        const Seen seen(walk_);
        const Pen pen = pen_;
        EdgeKey* out = batch.edges.data();
        for (std::size_t n = first; n < end; ++n) {
            if (n + kRecordsAhead < seen.size) seen.met.prefetch_record(seen.cells[n + kRecordsAhead]);
            out += pen.write_edges(seen.signs[n], seen.met.record(seen.cells[n]), out);
        }
        return static_cast<std::size_t>(out - batch.edges.data());
    }

    std::uint32_t* list_triangles(std::size_t first, std::size_t end, const Batch& batch, std::uint32_t* out,
                                  Drawn& lot) const {
        const Seen seen(walk_);
        const Pen pen = pen_;
        const std::uint32_t* places = batch.places.data();
        for (std::size_t n = first; n < end; ++n) {
            const auto [edges, corners] =
                pen.write_triangles(seen.signs[n], seen.met.record(seen.cells[n]), places, out, lot);
            places += edges;
            out += corners;
        }
        return out;
    }

    Pen pen_;
    const Walk<Cell, Value>& walk_;
};

}  // namespace isocore::thinning
