// box_edges.hpp - The crossed edges of several highrices of a block, in two lists: the kept ones, which lie on the
// boxes' surfaces and are the corners of their loops, and the dropped ones, whose distance to the triangles is
// measured.
//
// Boxes are added while there is room, then find() lists the edges of all. One long list for many boxes, because a loop
// over the three or four edges of a single box would end with a branch misprediction each time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "climbing/high_rice.hpp"
#include "climbing/triangles/drawn_site.hpp"
#include "common/array.hpp"
#include "common/set_bits.hpp"

namespace isocore::climbing {

// An edge and the number of its box, in one word: | box: 32..63 | edge: 0..31 |.
class BoxEdge {
  public:
    BoxEdge() = default;
    BoxEdge(Edge edge, std::size_t box) : word_(edge.word() | std::uint64_t{box} << 32) {}
    BoxEdge further(Edge steps) const { return BoxEdge(word_ + steps.word()); }  // moved by `steps`, byte by byte

    Edge edge() const { return Edge(static_cast<std::uint32_t>(word_)); }
    std::size_t box() const { return word_ >> 32; }

  private:
    explicit BoxEdge(std::uint64_t word) : word_(word) {}
    std::uint64_t word_;
};

class BoxEdges {
  public:
    // The edges of all boxes together are at most this many. The largest box alone has no more: each of its ligns is
    // crossed once at most.
    static constexpr std::size_t kMostEdges = 3 * Site::kRows;
    // The kept edges of one box are at most this many: they lie in its six faces of 32 + 32 ligns.
    static constexpr std::size_t kMostOfBox = 6 * 2 * 32;
    // No further box is added once this many edges are kept.
    static constexpr std::size_t kEnoughKept = 768;
    // So the kept edges of all boxes are at most this many.
    static constexpr std::size_t kMostKept = kEnoughKept + kMostOfBox;
    // And this many boxes suffice, as each keeps three edges at least.
    static constexpr std::size_t kMostBoxes = kEnoughKept / 3;

    explicit BoxEdges(int block_size);

    bool has_room(const HighRice& box) const {
        return counts_[size_].kept < kEnoughKept && ligns_ + count_ligns(box) <= kMostEdges;
    }
    // Adds a box that holds one disk, of the block that the site has loaded.
    void add(const DrawnSite& site, const HighRice& box);
    // Lists the edges of the boxes added so far.
    void find();
    void clear();

    std::size_t size() const { return size_; }  // boxes
    const HighRice& box(std::size_t n) const { return boxes_[n]; }
    // The edges of box n are those from first_...(n) to before first_...(n + 1) of the lists; n may be size().
    std::size_t first_kept(std::size_t n) const { return counts_[n].kept; }
    std::size_t first_dropped(std::size_t n) const { return counts_[n].dropped; }
    // The edges by box, row, axis and sample. A dropped edge in a high face of a box belongs to the box beyond it.
    std::span<const BoxEdge> kept() const { return {kept_.data(), counts_[size_].kept}; }
    std::span<const BoxEdge> dropped() const { return {dropped_.data(), counts_[size_].dropped}; }

  private:
    struct Counts {
        std::uint32_t kept = 0, dropped = 0;
    };
    // The tag of a window whose edges are still to be listed: which of them are kept, and the edge of its bit 0.
    struct Tag {
        DrawnSite::Window kept;
        BoxEdge start;
    };

    static std::size_t count_ligns(const HighRice& box) {
        const auto samples = [&](std::size_t axis) { return static_cast<std::size_t>(box.length(axis) + 1); };
        return samples(0) * (samples(1) + samples(2)) + samples(1) * samples(2);
    }
    void add_window(const DrawnSite& site, const HighRice& box, std::size_t window, int end);

    std::size_t size_ = 0, ligns_ = 0;  // boxes, and the ligns of all
    std::array<HighRice, kMostBoxes> boxes_;
    std::array<Counts, kMostBoxes + 1> counts_{};  // counts_[n]: the edges of the boxes before box n
    Array<BoxEdge> kept_, dropped_;                // each with one slot more, which find() may write to
    BoxEdge *kept_end_, *dropped_end_;             // where the listed edges end
    Array<TaggedWord<Tag>> windows_;               // those still to be listed; one slot more, as above
    TaggedWord<Tag>* windows_end_;
};

}  // namespace isocore::climbing
