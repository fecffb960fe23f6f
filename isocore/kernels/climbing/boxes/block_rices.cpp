// The traversal has no branch on the fate of a piece, which would be mispredicted half of the time. Instead each half
// is written to the end of every list that it might belong to, and the list's end moves on only if it does.
#include "climbing/boxes/block_rices.hpp"

#include <algorithm>
#include <array>

namespace isocore::climbing {

BlockRices::BlockRices(int block_size) : block_size_(block_size) {
    const auto rows = static_cast<std::size_t>(block_size * block_size),
               cells = rows * static_cast<std::size_t>(block_size);
    for (auto* pieces : {&boxes_, &pairs_}) pieces->resize(cells / 2 + 1);
    cells_.resize(rows);
}

void BlockRices::read(Fate fate, HalvingsReader& halvings) {
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

// Reads the halvings of a halved block in preorder: finds the boxes of several cells, and the halved pieces of two
// cells, whose number it returns.
std::size_t BlockRices::read_pieces(HalvingsReader& halvings) {
    constexpr std::size_t kDeepest = 3 * 5;  // a block of 32^3 can be halved so often
    std::array<Piece, kDeepest + 2> stack;   // the stack of halved pieces that are yet to be read
    std::size_t size = 0, pairs = 0, left = 0;
    for (Piece piece = Piece::block(block_size_);; piece = stack[--left]) {
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
        stack[left] = upper;
        left += !are_pairs & (of_upper == Fate::halved);
        stack[left] = lower;
        left += !are_pairs & (of_lower == Fate::halved);
        if (left == 0) break;
    }
    size_ = size;
    return pairs;
}

}  // namespace isocore::climbing
