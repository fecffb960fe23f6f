#include "climbing/crossings/layout.hpp"

#include <algorithm>
#include <bit>
#include <limits>
#include <stdexcept>

#include "common/parallel.hpp"
#include "samples/crossed_edges.hpp"

namespace isocore::climbing {
namespace {

// Exclusive prefix sum: turns counts into the sums of those before, the last entry into the sum of all, and returns it.
std::size_t add_up(Array<std::uint32_t>& counts, std::size_t limit) {
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

std::uint32_t ones(std::uint64_t word) { return static_cast<std::uint32_t>(std::popcount(word)); }

}  // namespace

Layout::Layout(const SignGrid& signs, int block_size, int threads)
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

std::size_t Layout::vertices_in(std::size_t j, std::size_t k) const {
    return count_kept(first_crossing(j, k), first_crossing_[strips_ * k + j / strip + 1]);
}

std::size_t Layout::number() {
    for (std::size_t n = 0; n + 1 < vertices_before_.size(); ++n)
        vertices_before_[n] = count_kept(kGroup * n, kGroup * (n + 1));
    return add_up(vertices_before_, static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()));
}

std::size_t Layout::vertex(std::size_t crossing) const {
    return vertices_before_[crossing / kGroup] + count_kept(crossing / kGroup * kGroup, crossing);
}

// How many of the crossings from `first` to before `end` are kept.
std::uint32_t Layout::count_kept(std::size_t first, std::size_t end) const {
    if (first >= end) return 0;
    std::uint64_t word = kept_[first / 64].load(std::memory_order_relaxed) & ~std::uint64_t{0} << first % 64;
    std::uint32_t out = 0;
    for (std::size_t w = first / 64; w < end / 64; word = kept_[++w].load(std::memory_order_relaxed)) out += ones(word);
    return out + ones(word & ~(~std::uint64_t{0} << end % 64));
}

}  // namespace isocore::climbing
