// Blocks halved at random, written down and read again.
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "check.hpp"
#include "climbing/boxes/block_rices.hpp"
#include "climbing/boxes/halvings.hpp"

namespace {

using namespace isocore::climbing;

struct Box {
    std::array<int, 3> low, length;
    bool operator==(const Box&) const = default;
};

int depth(const Box& box) {
    int depth = 0;
    for (const int length : box.length) depth += std::countr_zero(static_cast<unsigned>(length));
    return depth;
}

// Halves a block at random and notes what comes of it.
class RandomBlock {
  public:
    RandomBlock(int size, unsigned seed, Halvings& halvings)
        : size_(size), random_(seed), halvings_(halvings), cells_(static_cast<std::size_t>(size * size)) {
        const Box whole{{0, 0, 0}, {size, size, size}};
        const auto fate = size > 1 && random_() % 4 ? Fate::halved : Fate::highrice;
        halvings_.add_block(fate);
        if (fate == Fate::halved)
            halve(whole);
        else
            settle(whole);
    }

    int size() const { return size_; }
    const std::vector<Box>& boxes() const { return boxes_; }
    const std::vector<std::uint32_t>& cells() const { return cells_; }  // all, also those that hold nothing

  private:
    void halve(const Box& box) {
        auto axis = static_cast<unsigned>(random_() % 3), axes = 0u;
        while (box.length[axis] == 1) axis = (axis + 1) % 3;
        for (unsigned a = 0; a < 3; ++a) axes |= unsigned{box.length[a] > 1} << a;
        std::array<Box, 2> halves{box, box};
        for (Box& half : halves) half.length[axis] /= 2;
        halves[1].low[axis] += halves[1].length[axis];
        if (depth(box) == 1) {
            for (const Box& half : halves) settle(half);
            return;
        }
        std::array<Fate, 2> fates{};
        while (fates[0] == Fate::nothing && fates[1] == Fate::nothing) {
            for (Fate& fate : fates) fate = static_cast<Fate>(std::min<std::uint64_t>(random_() % 5, 2));
        }
        halvings_.add(axes, {static_cast<std::uint8_t>(axis), fates[0], fates[1]});
        for (std::size_t n = 0; n < 2; ++n) {
            if (fates[n] == Fate::highrice) settle(halves[n]);
        }
        for (std::size_t n = 0; n < 2; ++n) {
            if (fates[n] == Fate::halved) halve(halves[n]);
        }
    }
    void settle(const Box& box) {
        if (depth(box) > 0)
            boxes_.push_back(box);
        else
            cells_[static_cast<std::size_t>(box.low[1] + size_ * box.low[2])] |= 1u << box.low[0];
    }

    int size_;
    std::mt19937_64 random_;
    Halvings& halvings_;
    std::vector<Box> boxes_;
    std::vector<std::uint32_t> cells_;
};

void what_is_written_is_read() {
    for (const int size : {1, 2, 4, 8, 16, 32}) {
        Halvings halvings;
        std::vector<RandomBlock> blocks;
        for (unsigned seed = 0; seed < 40; ++seed) {
            halvings.add_block(Fate::nothing);
            blocks.emplace_back(size, seed, halvings);
        }
        halvings.shrink_to_fit();
        HalvingsReader reader(halvings);
        BlockRices rices(size);
        for (const RandomBlock& block : blocks) {
            CHECK(reader.next_block() == Fate::nothing);
            rices.read(reader.next_block(), reader);
            std::vector<Box> boxes;
            for (const Piece& piece : rices.boxes()) {
                const HighRice box = piece.within({size, size, size});
                boxes.push_back({{box.low[0], box.low[1], box.low[2]}, {box.length(0), box.length(1), box.length(2)}});
            }
            CHECK(boxes == block.boxes());
            for (int k = 0; k < size; ++k) {
                for (int j = 0; j < size; ++j)
                    CHECK(rices.cells(j, k) == block.cells()[static_cast<std::size_t>(j + size * k)]);
            }
        }
    }
}

void a_piece_ends_with_the_volume() {
    const Piece upper = Piece::block(8).halves(0).upper.halves(2).lower;
    CHECK((upper.within({8, 8, 8}) == HighRice{{4, 0, 0}, {8, 8, 4}}));
    CHECK((upper.within({5, 3, 4}) == HighRice{{4, 0, 0}, {5, 3, 4}}));
    CHECK((upper.within({2, 8, 1}) == HighRice{{2, 0, 0}, {2, 8, 1}}));
}

}  // namespace

void test_halvings() {
    what_is_written_is_read();
    a_piece_ends_with_the_volume();
}
