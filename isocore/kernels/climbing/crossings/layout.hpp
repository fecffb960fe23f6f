// layout.hpp - How neighbours agree on the vertices of their common faces. The paper lays out every face again after
// comparing the layout arrays of the highrices on both sides. Here every highrice keeps the crossings on its twelve
// edges, whichever thread it is in, and a crossing that any of them keeps is a vertex of the mesh. That takes one bit
// per crossing, in the order of crossed_edges.hpp:
//
//     crossing   0 1 2 3 4 5 6 7 8 9 ...
//     kept       1 0 0 1 1 0 1 0 0 1 ...     vertex(6) = rank of crossing 6 = kept crossings before it = 3
//     vertex     0     1 2   3     4
//
// A rank query adds two numbers: the kept crossings before the query's group of 512, from a table, and the popcount of
// at most eight words within that group.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/array.hpp"
#include "common/bit_fields.hpp"
#include "samples/signs.hpp"

namespace isocore::climbing {

class Layout {
  public:
    // The number of rows of a plane that are a strip, at most 8. Only the first row of a strip has the number of its
    // first crossing stored; the first row of every block starts a strip.
    const std::size_t strip;

    // Counts all crossings; none is kept yet. Throws std::length_error if there are 2^32 or more.
    Layout(const SignGrid& signs, int block_size, int threads);

    std::size_t crossings() const { return crossings_; }
    // The number of the first crossing of row (j, k), which must be the first row of a strip.
    std::uint32_t first_crossing(std::size_t j, std::size_t k) const {
        return first_crossing_[strips_ * k + j / strip];
    }
    // How many crossings of the strip that starts with row (j, k) are kept.
    std::size_t vertices_in(std::size_t j, std::size_t k) const;

    // Keeps a crossing; any thread may. False if it was kept before.
    bool keep(std::size_t crossing) {
        std::atomic<std::uint64_t>& word = kept_[crossing / 64];
        const std::uint64_t bit = std::uint64_t{1} << crossing % 64;
        if (word.load(std::memory_order_relaxed) & bit) return false;
        return !(word.fetch_or(bit, std::memory_order_relaxed) & bit);
    }

    // Keeps the crossings on some edges of a row, a bit each; any thread may. `crossed` are the crossed edges of the
    // row, the lowest of which has the crossing `first`:
    //     crossed  1 0 1 1 0 0 1     (lowest bit on the left)
    //     edges    1 1 0 1 0 0 0     extract_bits(edges, crossed) = 1 0 1 0: keeps crossings first and first + 2
    void keep(std::uint64_t crossed, std::uint64_t edges, std::size_t first) {
        const std::uint64_t bits = extract_bits(edges, crossed);
        keep_in_word(first / 64, bits << first % 64);
        if (first % 64 != 0) keep_in_word(first / 64 + 1, bits >> (64 - first % 64));
    }

    // The other way round: those of the crossed edges whose crossings are kept, a bit each.
    std::uint64_t kept(std::uint64_t crossed, std::size_t first) const {
        std::uint64_t bits = kept_[first / 64].load(std::memory_order_relaxed) >> first % 64;
        bits |= kept_[first / 64 + 1].load(std::memory_order_relaxed) << 1 << (63 - first % 64);
        return deposit_bits(bits, crossed);
    }

    // Numbers the vertices, anew if more were kept since the last time; returns how many there are. Throws
    // std::length_error if there are 2^31 or more.
    std::size_t number();

    // The vertex on a kept crossing. For a crossing that is not kept it is the vertex on the next one that is: the rank
    // is the same.
    std::size_t vertex(std::size_t crossing) const;

  private:
    static constexpr std::size_t kGroup = 512;  // crossings

    void keep_in_word(std::size_t word, std::uint64_t bits) {
        if (bits & ~kept_[word].load(std::memory_order_relaxed)) kept_[word].fetch_or(bits, std::memory_order_relaxed);
    }
    std::uint32_t count_kept(std::size_t first, std::size_t end) const;

    std::size_t strips_, crossings_ = 0;            // strips: of each plane
    Array<std::uint32_t> first_crossing_;           // by strip, and then the number of all crossings
    std::vector<std::atomic<std::uint64_t>> kept_;  // a bit per crossing, and one word more that may be read
    Array<std::uint32_t> vertices_before_;          // before each group of crossings, and then all vertices
};

}  // namespace isocore::climbing
