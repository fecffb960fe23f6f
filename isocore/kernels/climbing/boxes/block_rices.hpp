// block_rices.hpp - The highrices of one block, read from its halvings. A processor cannot guess what becomes of a
// piece, so that no piece takes a branch.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "climbing/boxes/halvings.hpp"
#include "climbing/crossings/site.hpp"
#include "common/array.hpp"

namespace isocore::climbing {

class BlockRices {
  public:
    explicit BlockRices(int block_size) : block_size_(block_size) {
        const auto rows = static_cast<std::size_t>(block_size * block_size),
                   cells = rows * static_cast<std::size_t>(block_size);
        for (auto* pieces : {&boxes_, &pairs_}) pieces->resize(cells / 2 + 1);
        cells_.resize(rows);
    }

    // Of a block that is a highrice, or halved; then its halvings are the next ones.
    void read(Fate fate, HalvingsReader& halvings) {
        std::size_t pairs = 0;
        size_ = 0;
        std::fill(cells_.begin(), cells_.end(), block_size_ == 1);
        if (fate == Fate::halved)
            pairs = read_pieces(halvings);
        else if (block_size_ > 1)
            boxes_[size_++] = Piece::block(block_size_);
        for (const Piece& pair : std::span(pairs_.data(), pairs)) {
            const unsigned along_x = pair.axes() & 1, along_y = pair.axes() >> 1 & 1, along_z = pair.axes() >> 2;
            const auto row = static_cast<std::size_t>(pair.low(1) + block_size_ * pair.low(2));
            const auto next = row + along_y + along_z * static_cast<unsigned>(block_size_);
            cells_[row] |= std::uint32_t{1} << pair.low(0);
            cells_[next] |= std::uint32_t{1} << along_x << pair.low(0);
        }
    }

    // Those of several cells.
    std::span<const Piece> boxes() const { return {boxes_.data(), size_}; }

    // Single cells of a row that are no part of a box, a bit each; some may hold nothing.
    std::uint32_t cells(int j, int k) const { return cells_[static_cast<std::size_t>(j + block_size_ * k)]; }

    // Calls visit(j, k, cells) for every row of the block with highrices of one cell, a bit each.
    template <class Visit>
    void visit_cells(const Site& site, const Visit& visit) const {
        for (int k = 0; k < site.cells[2]; ++k) {
            for (int j = 0; j < site.cells[1]; ++j) {
                const std::uint32_t single = cells(j, k);
                if (single == 0) continue;
                const std::uint64_t a = site.row(j, k).signs, b = site.row(j + 1, k).signs,
                                    c = site.row(j, k + 1).signs, d = site.row(j + 1, k + 1).signs;
                const std::uint64_t any = a | b | c | d, all = a & b & c & d;
                const std::uint64_t inside = (std::uint64_t{1} << site.cells[0]) - 1;
                if (const std::uint64_t crossed = single & inside & (any | any >> 1) & ~(all & all >> 1))
                    visit(j, k, crossed);
            }
        }
    }

  private:
    // Finds boxes, and pairs of cells; returns how many of the latter.
    std::size_t read_pieces(HalvingsReader& halvings) {
        constexpr std::size_t kDeepest = 3 * 5;
        std::array<Piece, kDeepest + 2> later;
        std::size_t size = 0, pairs = 0, left = 0;
        for (Piece piece = Piece::block(block_size_);; piece = later[--left]) {
            const auto [axis, of_lower, of_upper] = halvings.next(piece.axes());
            const auto [lower, upper] = piece.halves(axis);
            boxes_[size] = lower;
            size += of_lower == Fate::highrice;
            boxes_[size] = upper;
            size += of_upper == Fate::highrice;
            const bool are_pairs = lower.depth() == 1;
            pairs_[pairs] = lower;
            pairs += are_pairs & (of_lower == Fate::halved);
            pairs_[pairs] = upper;
            pairs += are_pairs & (of_upper == Fate::halved);
            later[left] = upper;
            left += !are_pairs & (of_upper == Fate::halved);
            later[left] = lower;
            left += !are_pairs & (of_lower == Fate::halved);
            if (left == 0) break;
        }
        size_ = size;
        return pairs;
    }

    int block_size_;
    Array<Piece> boxes_, pairs_;  // of cells; and room for one that is none
    Array<std::uint32_t> cells_;  // by rows [k][j]
    std::size_t size_ = 0;        // of the boxes
};

}  // namespace isocore::climbing
