// corners.hpp - The corners of a few consecutive vertices, vertex by vertex.
// A mesh is looked at through windows of vertices, so that a window's corners stay in the cache and every thread
// has windows of its own. Which triangles reach into a window is known from the range of each block of triangles.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/array.hpp"

namespace isocore {

constexpr std::size_t kTrianglesPerBlock = 2048;

// The vertices that a block of triangles names.
struct VertexRange {
    std::int32_t lowest;
    std::int32_t highest;
};

// An edge opposite to a vertex, in the direction in which its triangle runs along it. Its ends are given by how far
// they are from the vertex: negative is earlier, and zero is neither. Wherever neighbours have neighbouring indices
// that fits into 16 bits, which halves the memory to go through.
template <class Offset>
struct LinkEdge {
    Offset from;
    Offset to;
};

// Room for eight edges. Most vertices have fewer, and then the other slots hold leftovers of no meaning.
constexpr std::size_t kSlots = 8;
template <class Offset>
struct alignas(kSlots * sizeof(LinkEdge<Offset>)) Slots {
    std::array<LinkEdge<Offset>, kSlots> edges;
};

using Link = std::vector<LinkEdge<std::int32_t>>;

// Offset: std::int16_t where no block's range exceeds `kShortRange`, else std::int32_t.
constexpr std::int32_t kShortRange = 32767;
inline bool has_short_ranges(const std::vector<VertexRange>& blocks) {
    const auto is_short = [](VertexRange range) { return range.highest - range.lowest <= kShortRange; };
    return std::all_of(blocks.begin(), blocks.end(), is_short);
}

template <class Offset>
class Corners {
  public:
    Corners(const std::int32_t* triangles, std::size_t triangle_count, const std::vector<VertexRange>& blocks)
        : triangles_(triangles), triangle_count_(triangle_count), blocks_(blocks) {}

    // Collects the corners of vertices begin .. end - 1. Triangles with a repeated corner are left out.
    void look_at(std::size_t begin, std::size_t end);

    // How many corners a vertex has; kSlots + 1 stands for any number that the slots cannot hold.
    std::size_t count(std::size_t vertex) const { return counts_[vertex - begin_]; }
    // The first eight link edges of a vertex, or all, in the order of their triangles.
    const Slots<Offset>& slots(std::size_t vertex) const { return slots_[vertex - begin_]; }
    // All link edges of a vertex, however many.
    void copy_link(std::size_t vertex, Link& link) const;

  private:
    struct Spilled {
        std::uint32_t index;
        LinkEdge<Offset> edge;
    };

    template <bool kAllInside>
    void add_block(const std::int32_t* corners, const std::int32_t* last);
    void spill(const Spilled& corner);

    const std::int32_t* triangles_;
    std::size_t triangle_count_;
    const std::vector<VertexRange>& blocks_;
    std::size_t begin_ = 0;
    Array<std::uint8_t> counts_;
    std::vector<Slots<Offset>> slots_;
    std::vector<Spilled> spilled_;  // what the slots cannot hold, by vertex
};

// The number of vertices in a window: few where neighbours have neighbouring indices, as in a fresh surface,
// and many where every window would have to look through the whole mesh.
std::size_t window_size(const std::vector<VertexRange>& blocks, std::size_t vertex_count, int threads);

}  // namespace isocore
