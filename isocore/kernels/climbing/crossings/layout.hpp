// layout.hpp - How neighbours share their cuts. The paper lays out every face again after comparing the cuts of the
// highrices on both sides; here both sides keep the crossings on the twelve edges of their boxes, and what is kept by
// any box is a vertex of the mesh. One bit per crossing, in the order of crossed_edges.hpp, is all that this takes.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <vector>

#include "common/array.hpp"
#include "common/bit_fields.hpp"
#include "common/parallel.hpp"
#include "samples/crossed_edges.hpp"

namespace isocore::climbing {

// Crossings of the edges of row (j, k) along each axis.
inline std::array<std::uint32_t, 3> count_crossings(const SignGrid& signs, std::size_t j, std::size_t k) {
    std::uint32_t x = 0, y = 0, z = 0;
    const auto ones = [](std::uint64_t word) { return static_cast<std::uint32_t>(std::popcount(word)); };
    for (std::size_t w = 0; w < signs.words; ++w) {
        x += ones(crossed_edges(signs, 0, j, k, w));
        y += ones(crossed_edges(signs, 1, j, k, w));
        z += ones(crossed_edges(signs, 2, j, k, w));
    }
    return {x, y, z};
}

class Layout {
  public:
    const std::size_t strip;  // so many rows at most are numbered together; blocks start with a strip

    Layout(const SignGrid& signs, int block_size, int threads)
        : strip(std::min<std::size_t>(8, static_cast<std::size_t>(block_size))),
          strips_((signs.dims[1] - 1) / strip + 1),
          first_crossing_(strips_ * signs.dims[2] + 1) {
        parallel_for(threads, signs.dims[2], [&](std::size_t k) {
            std::fill_n(first_crossing_.begin() + static_cast<std::ptrdiff_t>(strips_ * k), strips_, 0);
            for (std::size_t j = 0; j < signs.dims[1]; ++j) {
                const auto counts = count_crossings(signs, j, k);
                first_crossing_[strips_ * k + j / strip] += counts[0] + counts[1] + counts[2];
            }
        });
        crossings_ = add_up(first_crossing_, std::numeric_limits<std::uint32_t>::max());
        kept_ = std::vector<std::atomic<std::uint64_t>>(kGroup / 64 * (crossings_ / kGroup + 1) + 1);
        vertices_before_.resize(crossings_ / kGroup + 2);
    }

    std::size_t crossings() const { return crossings_; }
    // The number of the first crossing of row (j, k), with which a strip starts.
    std::uint32_t first_crossing(std::size_t j, std::size_t k) const {
        return first_crossing_[strips_ * k + j / strip];
    }
    // Those that are kept in that row's strip.
    std::size_t vertices_in(std::size_t j, std::size_t k) const {
        return count(first_crossing(j, k), first_crossing_[strips_ * k + j / strip + 1]);
    }

    // Keeps a crossing, from any thread. False if it was kept before.
    bool keep(std::size_t crossing) {
        std::atomic<std::uint64_t>& word = kept_[crossing / 64];
        const std::uint64_t bit = std::uint64_t{1} << crossing % 64;
        if (word.load(std::memory_order_relaxed) & bit) return false;
        return !(word.fetch_or(bit, std::memory_order_relaxed) & bit);
    }

    // Keeps those of some crossed edges that are cut, if the first of them is the crossing `first`.
    void keep(std::uint64_t crossed, std::uint64_t cut, std::size_t first) {
        const std::uint64_t bits = extract_bits(cut, crossed);
        add(first / 64, bits << first % 64);
        if (first % 64 != 0) add(first / 64 + 1, bits >> (64 - first % 64));
    }

    // How many of the crossings from `first` to before `end` are kept.
    std::uint32_t count(std::size_t first, std::size_t end) const {
        if (first >= end) return 0;
        std::uint64_t word = kept_[first / 64].load(std::memory_order_relaxed) & ~std::uint64_t{0} << first % 64;
        std::uint32_t out = 0;
        for (std::size_t w = first / 64; w < end / 64; word = kept_[++w].load(std::memory_order_relaxed))
            out += ones(word);
        return out + ones(word & ~(~std::uint64_t{0} << end % 64));
    }

    // Those of some crossed edges that are kept, if the first of them is the crossing `first`.
    std::uint64_t kept(std::uint64_t crossed, std::size_t first) const {
        std::uint64_t bits = kept_[first / 64].load(std::memory_order_relaxed) >> first % 64;
        bits |= kept_[first / 64 + 1].load(std::memory_order_relaxed) << 1 << (63 - first % 64);
        return deposit_bits(bits, crossed);
    }

    // Numbers the vertices anew; returns how many there are.
    std::size_t number() {
        for (std::size_t n = 0; n + 1 < vertices_before_.size(); ++n)
            vertices_before_[n] = count(kGroup * n, kGroup * (n + 1));
        return add_up(vertices_before_, static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()));
    }

    // The vertex that a crossing is, or the next one that is kept.
    std::size_t vertex(std::size_t crossing) const {
        return vertices_before_[crossing / kGroup] + count(crossing / kGroup * kGroup, crossing);
    }

  private:
    void add(std::size_t word, std::uint64_t bits) {
        if (bits & ~kept_[word].load(std::memory_order_relaxed)) kept_[word].fetch_or(bits, std::memory_order_relaxed);
    }
    static std::uint32_t ones(std::uint64_t word) { return static_cast<std::uint32_t>(std::popcount(word)); }

    // Turns counts into the sums of those before; the last one becomes the sum of all.
    static std::size_t add_up(Array<std::uint32_t>& counts, std::size_t limit) {
        std::size_t sum = 0;
        counts.back() = 0;
        for (std::uint32_t& n : counts) {
            const std::uint32_t count = n;
            n = static_cast<std::uint32_t>(sum);
            sum += count;
            if (sum > limit)
                throw std::length_error(
                    "the surface has more vertices than 2^31 - 1; crop the volume or choose another isovalue");
        }
        return sum;
    }

    static constexpr std::size_t kGroup = 512;  // crossings

    std::size_t strips_, crossings_ = 0;            // strips of a plane
    Array<std::uint32_t> first_crossing_;           // by strip, and one more
    std::vector<std::atomic<std::uint64_t>> kept_;  // a bit per crossing
    Array<std::uint32_t> vertices_before_;          // those before each group of crossings, and one more
};

}  // namespace isocore::climbing
