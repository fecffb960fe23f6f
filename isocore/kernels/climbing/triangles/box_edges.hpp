// box_edges.hpp - The crossed edges of several highrices of a block: those on a box's surface that are kept, and those
// that are dropped.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "climbing/high_rice.hpp"
#include "climbing/triangles/drawn_site.hpp"
#include "common/array.hpp"
#include "common/set_bits.hpp"

namespace isocore::climbing {

// An edge and the number of its box, in one word.
class BoxEdge {
  public:
    BoxEdge() = default;
    BoxEdge(Edge edge, std::size_t box) : word_(edge.word() | std::uint64_t{box} << 32) {}
    BoxEdge further(Edge steps) const { return BoxEdge(word_ + steps.word()); }

    Edge edge() const { return Edge(static_cast<std::uint32_t>(word_)); }
    std::size_t box() const { return word_ >> 32; }

  private:
    explicit BoxEdge(std::uint64_t word) : word_(word) {}
    std::uint64_t word_;
};

// Takes boxes as long as there is room, then finds their edges by whole rows of the block. Lists are of all boxes, one
// after the other, as a processor can guess where a long list ends and not where a short one does.
class BoxEdges {
  public:
    // Edges of all boxes at most. As no lign of a box is crossed twice, even the largest one has no more.
    static constexpr std::size_t kRoom = 3 * Site::kRows;
    // Kept edges: of one box at most, for the same reason; so many that no box is added any more; and of all boxes at
    // most.
    static constexpr std::size_t kMostOfBox = 6 * 2 * 32, kEnough = 768, kMostKept = kEnough + kMostOfBox;
    static constexpr std::size_t kMostBoxes = kEnough / 3;  // as each keeps three at least

    explicit BoxEdges(int block_size) {
        const auto samples = static_cast<std::size_t>(block_size + 1),
                   halves = std::size_t{block_size > DrawnSite::kHalf ? 2u : 1u};
        rows_.resize(kManyRows + halves * samples * samples + 1);
        rows_end_ = rows_.data();
        for (Array<BoxEdge>* edges : {&kept_, &dropped_}) edges->resize(kRoom + 1);
        clear();
    }

    bool has_room(const HighRice& box) const {
        return ends_[size_].kept < kEnough && ligns_ + count_ligns(box) <= kRoom;
    }

    // A disk box.
    void add(const DrawnSite& site, const HighRice& box) {
        boxes_[size_] = box;
        ligns_ += count_ligns(box);
        Ends& ends = ends_[size_ + 1] = ends_[size_];
        const int middle = DrawnSite::kHalf;
        if (box.low[0] < middle)
            add(site, box, 0, std::min<int>(box.high[0], box.high[0] > middle ? middle - 1 : middle), ends);
        if (box.high[0] > middle) add(site, box, 1, box.high[0], ends);
        ++size_;
        if (rows_end_ > rows_.data() + kManyRows) find();
    }

    // Of the boxes that were added.
    void find() {
        BoxEdge *kept = kept_end_, *dropped = dropped_end_;
        visit_bits(rows_.data(), std::exchange(rows_end_, rows_.data()), [&](const Row& row, int bit) {
            *kept = *dropped = row.start.further(kSteps[static_cast<std::size_t>(bit)]);
            const std::size_t is_kept = row.kept >> bit & 1;
            kept += is_kept;
            dropped += 1 - is_kept;
        });
        kept_end_ = kept;
        dropped_end_ = dropped;
    }

    void clear() {
        size_ = ligns_ = 0;
        kept_end_ = kept_.data();
        dropped_end_ = dropped_.data();
    }

    std::size_t size() const { return size_; }
    const HighRice& box(std::size_t n) const { return boxes_[n]; }
    // Where the edges of box n start; of the first one that is not there, where all end.
    std::size_t first_kept(std::size_t n) const { return ends_[n].kept; }
    std::size_t first_dropped(std::size_t n) const { return ends_[n].dropped; }
    // In the order of boxes, rows, axes and samples. Dropped ones in a high face of a box are left to the box beyond.
    std::span<const BoxEdge> kept() const { return {kept_.data(), ends_[size_].kept}; }
    std::span<const BoxEdge> dropped() const { return {dropped_.data(), ends_[size_].dropped}; }

  private:
    using Half = DrawnSite::Half;
    static constexpr int kWindow = DrawnSite::kWindow;

    static constexpr std::size_t kManyRows = 256;  // more are not kept waiting

    struct Ends {
        std::uint32_t kept = 0, dropped = 0;
    };
    struct Row {
        Half kept;
        BoxEdge start;
    };
    // From the start of a row to the edge of a bit.
    static constexpr std::array<Edge, 64> kSteps = [] {
        std::array<Edge, 64> steps{};
        for (int bit = 0; bit < 3 * kWindow; ++bit) {
            steps[static_cast<std::size_t>(bit)] =
                Edge::along_x(static_cast<unsigned>(bit % kWindow), 0, 0).of_axis(bit / kWindow);
        }
        return steps;
    }();

    static std::size_t count_ligns(const HighRice& box) {
        const auto samples = [&](std::size_t axis) { return static_cast<std::size_t>(box.length(axis) + 1); };
        return samples(0) * (samples(1) + samples(2)) + samples(1) * samples(2);
    }

    // Adds those that start in half a row, at samples up to `end`.
    void add(const DrawnSite& site, const HighRice& box, std::size_t half, int end, Ends& ends) {
        const int origin = half ? DrawnSite::kHalf : 0, start = std::max<int>(box.low[0] - origin, 0);
        const auto up_to = [&](int sample) { return (Half{2} << (sample - origin)) - (Half{1} << start); };
        std::array<bool, 3> owns_end;  // is there no box beyond?
        for (std::size_t a = 0; a < 3; ++a) owns_end[a] = box.high[a] == site.cells[a] && site.ends_grid[a];
        const int last_own = end == box.high[0] && !owns_end[0] ? end - 1 : end;
        const Half along = up_to(std::min(end, box.high[0] - 1)), closed = up_to(end) << kWindow,
                   own = up_to(last_own) << kWindow;
        // By whether the row is the box's last along z, and along y.
        using Masks = std::array<std::array<Half, 2>, 2>;
        const Masks kept{{{along | closed | closed << kWindow, along | closed << kWindow}, {along | closed, along}}};
        const auto if_own = [&](std::size_t axis, Half mask) { return owns_end[axis] ? mask : 0; };
        const Masks dropped{{{along | own | own << kWindow, if_own(1, along | own << kWindow)},
                             {if_own(2, along | own), if_own(1, if_own(2, along))}}};
        Ends own_ends = ends;
        WordAdder<Row> add(rows_end_);
        const auto add_row = [&](const DrawnSite::Cut& cut, Half kept_here, Half dropped_here, BoxEdge first) {
            const Half is_kept = cut.kept_halves[half] & kept_here,
                       is_dropped = cut.dropped_halves[half] & dropped_here;
            own_ends.kept += static_cast<std::uint32_t>(std::popcount(is_kept));
            own_ends.dropped += static_cast<std::uint32_t>(std::popcount(is_dropped));
            add(is_kept | is_dropped, {is_kept, first});
        };
        const auto rows = static_cast<unsigned>(box.length(1)), planes = static_cast<unsigned>(box.length(2));
        const auto add_plane = [&](unsigned k, const std::array<Half, 2>& kept_here,
                                   const std::array<Half, 2>& dropped_here) {
            const DrawnSite::Cut* cut = &site.cut(box.low[1], static_cast<int>(box.low[2] + k));
            BoxEdge first(Edge::along_x(static_cast<unsigned>(origin), box.low[1], box.low[2] + k), size_);
            for (unsigned j = 0; j < rows; ++j, ++cut, first = first.further(Edge::along_x(0, 1, 0))) {
                add_row(*cut, kept_here[0], dropped_here[0], first);
            }
            add_row(*cut, kept_here[1], dropped_here[1], first);
        };
        for (unsigned k = 0; k < planes; ++k) add_plane(k, kept[0], dropped[0]);
        add_plane(planes, kept[1], dropped[1]);
        ends = own_ends;
    }

    std::size_t size_ = 0, ligns_ = 0;  // of all boxes
    std::array<HighRice, kMostBoxes> boxes_;
    std::array<Ends, kMostBoxes + 1> ends_{};  // of the boxes before each, and of all
    Array<BoxEdge> kept_, dropped_;            // and room for one that is not
    BoxEdge *kept_end_, *dropped_end_;         // of those that were found
    Array<TaggedWord<Row>> rows_;              // whose edges are yet to be found, and one more to write to
    TaggedWord<Row>* rows_end_;
};

}  // namespace isocore::climbing
