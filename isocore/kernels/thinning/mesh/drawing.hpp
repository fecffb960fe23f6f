// drawing.hpp - Draws a lot of visited cells in three passes, so that none waits for another cell's: the crossed edges
// of all cells, their places in the lot's table, the triangles between these places.
#pragma once

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

    // Draws the visited cells from the first on, as far as the end; their edges join those in the table.
    void draw(std::size_t first, std::size_t end, DrawScratch& scratch, Drawn& out) const {
        if (first == end) return;
        list_edges(first, end, scratch);
        scratch.table.place(scratch.edges.data(), scratch.edges.size(), scratch.places.data());
        list_triangles(first, end, scratch, out);
    }

  private:
    using Pen = std::conditional_t<std::is_same_v<Cell, mesh::Tet>, TetPen<Value>, HexPen<Value>>;

    void list_edges(std::size_t first, std::size_t end, DrawScratch& scratch) const {
        constexpr std::size_t kRecordsAhead = 12, kValuesAhead = 6;
        scratch.signs.resize(end - first);
        scratch.edges.resize(Pen::kMostEdges * (end - first));
        const std::int32_t* cells = walk_.cells();
        std::uint8_t* signs_of = scratch.signs.data() - first;
        EdgeKey* out = scratch.edges.data();
        for (std::size_t n = first; n < end; ++n) {
            if (n + kRecordsAhead < end) walk_.prefetch_record(cells[n + kRecordsAhead]);
            if (n + kValuesAhead < end) walk_.prefetch_values(cells[n + kValuesAhead]);
            const std::int32_t* corners = walk_.record(cells[n]);
            const mesh::Mask signs = walk_.signs(corners);
            signs_of[n] = static_cast<std::uint8_t>(signs);
            out += pen_.write_edges(signs, corners, out);
        }
        scratch.edges.resize(static_cast<std::size_t>(out - scratch.edges.data()));
        scratch.places.resize(scratch.edges.size() + Pen::kMostEdges);
    }

    void list_triangles(std::size_t first, std::size_t end, const DrawScratch& scratch, Drawn& lot) const {
        const std::size_t before = lot.triangles.size();
        lot.triangles.resize(before + Pen::kMostCorners * (end - first));
        std::uint32_t* out = lot.triangles.data() + before;
        const std::uint32_t* places = scratch.places.data();
        const std::int32_t* cells = walk_.cells();
        for (std::size_t n = first; n < end; ++n) {
            const auto [edges, corners] =
                pen_.write_triangles(scratch.signs[n - first], walk_.record(cells[n]), places, out, lot);
            places += edges;
            out += corners;
        }
        lot.triangles.resize(static_cast<std::size_t>(out - lot.triangles.data()));
    }

    Pen pen_;
    const Walk<Cell, Value>& walk_;
};

}  // namespace isocore::thinning
