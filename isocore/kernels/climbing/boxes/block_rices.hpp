// block_rices.hpp - The highrices of one block, read from its halvings.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "climbing/boxes/halvings.hpp"
#include "climbing/crossings/site.hpp"
#include "common/array.hpp"

namespace isocore::climbing {

class BlockRices {
  public:
    explicit BlockRices(int block_size);

    // Reads a block that is a highrice or is halved; if it is halved, its halvings must be the reader's next ones.
    void read(Fate fate, HalvingsReader& halvings);

    // The highrices of several cells, in the order of the halvings that they are halves of, lower halves first.
    std::span<const Piece> boxes() const { return {boxes_.data(), size_}; }

    // The cells of row (j, k) that are in no box of several cells and in no piece that holds nothing, a bit each. Not
    // all of these are highrices: the surface may leave a cell beside one that it crosses uncrossed.
    std::uint32_t cells(int j, int k) const { return cells_[static_cast<std::size_t>(j + block_size_ * k)]; }

    // Calls visit(j, k, cells) for every row (j, k) of the block that has highrices of one cell, a bit each in `cells`:
    // those of cells(j, k) whose corners have different signs. `site` is loaded with the block.
    template <class Visit>
    void visit_cells(const Site& site, const Visit& visit) const {
        for (int k = 0; k < site.cells[2]; ++k) {
            for (int j = 0; j < site.cells[1]; ++j) {
                const std::uint32_t single = cells(j, k);
                if (single == 0) continue;
                const std::uint64_t a = site.row(j, k).signs, b = site.row(j + 1, k).signs,
                                    c = site.row(j, k + 1).signs, d = site.row(j + 1, k + 1).signs;
                const std::uint64_t any = a | b | c | d, all = a & b & c & d;
                const std::uint64_t in_volume = (std::uint64_t{1} << site.cells[0]) - 1;
                if (const std::uint64_t crossed = single & in_volume & (any | any >> 1) & ~(all & all >> 1))
                    visit(j, k, crossed);
            }
        }
    }

  private:
    std::size_t read_pieces(HalvingsReader& halvings);

    int block_size_;
    Array<Piece> boxes_, pairs_;  // pairs: of cells. Each has room for one entry more, which is written but not kept
    Array<std::uint32_t> cells_;  // [k][j], a bit for each cell of the row
    std::size_t size_ = 0;        // boxes
};

}  // namespace isocore::climbing
