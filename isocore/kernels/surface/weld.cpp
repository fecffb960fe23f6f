// weld.cpp - A hash table of places, cut into parts by hash: every thread goes over all vertices in order and looks
// after those of its own part, so the earliest vertex of a place is always found first.
#include "surface/weld.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <type_traits>
#include <vector>

#include "common/parallel.hpp"
#include "common/prefetch.hpp"

namespace isocore {
namespace {

constexpr std::size_t kBlock = 16384;
constexpr std::size_t kAhead = 16;  // vertices between a slot's prefetch and its use

template <class Real>
using Place = std::array<std::conditional_t<sizeof(Real) == 4, std::uint32_t, std::uint64_t>, 3>;

// The bits of a place; adding zero turns minus zero into zero.
template <class Real>
Place<Real> place_of(const Real* vertices, std::size_t v) {
    const Real* p = vertices + 3 * v;
    return std::bit_cast<Place<Real>>(std::array<Real, 3>{p[0] + Real{0}, p[1] + Real{0}, p[2] + Real{0}});
}

template <class Bits>
std::uint32_t hash_of(const std::array<Bits, 3>& place) {
    std::uint64_t hash = 0;
    for (const Bits bits : place) {
        hash = (hash ^ bits) * 0x9E3779B97F4A7C15U;
        hash ^= hash >> 29;
    }
    return static_cast<std::uint32_t>((hash * 0xBF58476D1CE4E5B9U) >> 32);
}

// One part of the table. A slot holds a vertex and its hash, or nothing (all bits set).
struct Slot {
    std::int32_t vertex = -1;
    std::uint32_t hash = 0;
};

template <class Real>
class Part {
  public:
    Part(const Real* vertices, const Array<std::uint32_t>& hashes, std::size_t part, std::size_t parts)
        : vertices_(vertices), hashes_(hashes), part_(part), parts_(parts) {
        std::size_t own = 0;
        for (const std::uint32_t hash : hashes) own += is_own(hash);
        slots_.resize(std::bit_ceil(own + own / 2 + 1));
    }

    // Writes the earliest vertex of the same place beside each vertex of this part; returns how many are not it.
    std::size_t run(Array<std::int32_t>& earliest) {
        std::size_t merged = 0;
        for (std::size_t v = 0; v < hashes_.size(); ++v) {
            if (v + kAhead < hashes_.size()) ISOCORE_PREFETCH(&slots_[slot_of(hashes_[v + kAhead])]);
            if (!is_own(hashes_[v])) continue;
            earliest[v] = find_or_keep(static_cast<std::int32_t>(v));
            merged += earliest[v] != static_cast<std::int32_t>(v);
        }
        return merged;
    }

  private:
    bool is_own(std::uint32_t hash) const { return parts_ == 1 || hash % parts_ == part_; }
    std::size_t slot_of(std::uint32_t hash) const { return (hash / parts_) & (slots_.size() - 1); }

    std::int32_t find_or_keep(std::int32_t vertex) {
        const auto v = static_cast<std::size_t>(vertex);
        const std::uint32_t hash = hashes_[v];
        for (std::size_t n = slot_of(hash);; n = (n + 1) & (slots_.size() - 1)) {
            Slot& slot = slots_[n];
            if (slot.vertex < 0) {
                slot = {vertex, hash};
                return vertex;
            }
            if (slot.hash != hash) continue;
            if (place_of(vertices_, static_cast<std::size_t>(slot.vertex)) == place_of(vertices_, v))
                return slot.vertex;
        }
    }

    const Real* vertices_;
    const Array<std::uint32_t>& hashes_;
    std::size_t part_, parts_;
    std::vector<Slot> slots_;
};

}  // namespace

template <class Real>
Array<std::int32_t> weld(const Real* vertices, std::size_t count, int threads) {
    Array<std::uint32_t> hashes(count);
    parallel_for(threads, (count + kBlock - 1) / kBlock, [&](std::size_t block) {
        const std::size_t end = std::min(count, (block + 1) * kBlock);
        for (std::size_t v = block * kBlock; v < end; ++v) hashes[v] = hash_of(place_of(vertices, v));
    });
    Array<std::int32_t> earliest(count);
    const auto parts = static_cast<std::size_t>(std::clamp(threads, 1, 16));
    std::vector<std::size_t> merged(parts);
    parallel_for(threads, parts,
                 [&](std::size_t part) { merged[part] = Part<Real>(vertices, hashes, part, parts).run(earliest); });
    if (std::all_of(merged.begin(), merged.end(), [](std::size_t n) { return n == 0; })) earliest.clear();
    return earliest;
}

template Array<std::int32_t> weld(const float*, std::size_t, int);
template Array<std::int32_t> weld(const double*, std::size_t, int);

}  // namespace isocore
