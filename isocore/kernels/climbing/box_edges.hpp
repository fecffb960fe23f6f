// box_edges.hpp - The crossed edges of a highrice: those on its surface that are kept, and those that are dropped.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "climbing/drawn_site.hpp"
#include "climbing/edge.hpp"
#include "climbing/high_rice.hpp"
#include "common/array.hpp"
#include "common/set_bits.hpp"

namespace isocore::climbing {

// Finds them by whole rows of the block.
class BoxEdges {
  public:
    explicit BoxEdges(int block_size) {
        const auto samples = static_cast<std::size_t>(block_size + 1);
        for (Array<Edge>* edges : {&kept_, &dropped_}) edges->resize(3 * samples * samples + 1);  // no lign of a box is crossed twice
    }

    // In the order of their rows, axes and samples. Dropped ones in a high face of the box are left to the box beyond.
    void find(const DrawnSite& site, const HighRice& box) {
        const int middle = DrawnSite::kHalf;
        if (box.low[0] < middle) find(site, box, 0, std::min<int>(box.high[0], box.high[0] > middle ? middle - 1 : middle));
        if (box.high[0] > middle) find(site, box, 1, box.high[0]);
        Edge *kept = kept_.data(), *dropped = dropped_.data();
        found_.visit([&](const Row& row, int bit) {
            const int axis = bit / kWindow;
            *kept = *dropped = row.start.further_along_x(bit - kWindow * axis).of_axis(axis);
            const std::size_t is_kept = row.kept >> bit & 1;
            kept += is_kept;
            dropped += 1 - is_kept;
        });
        kept_size_ = static_cast<std::size_t>(kept - kept_.data());
        dropped_size_ = static_cast<std::size_t>(dropped - dropped_.data());
    }

    std::span<const Edge> kept() const { return {kept_.data(), kept_size_}; }
    std::span<const Edge> dropped() const { return {dropped_.data(), dropped_size_}; }

  private:
    using Half = DrawnSite::Half;
    static constexpr int kWindow = DrawnSite::kWindow;

    // Finds those that start in half a row, at samples up to `end`.
    void find(const DrawnSite& site, const HighRice& box, std::size_t half, int end) {
        const int origin = half ? DrawnSite::kHalf : 0, start = std::max<int>(box.low[0] - origin, 0);
        const auto up_to = [&](int sample) { return (Half{2} << (sample - origin)) - (Half{1} << start); };
        std::array<bool, 3> owns_end;  // is there no box beyond?
        for (std::size_t a = 0; a < 3; ++a) owns_end[a] = box.high[a] == site.cells[a] && site.ends_grid[a];
        const int last_own = end == box.high[0] && !owns_end[0] ? end - 1 : end;
        const Half along = up_to(std::min(end, box.high[0] - 1)), closed = up_to(end) << kWindow, own = up_to(last_own) << kWindow;
        // By whether the row is the box's last along z, and along y.
        using Masks = std::array<std::array<Half, 2>, 2>;
        const Masks kept{{{along | closed | closed << kWindow, along | closed << kWindow}, {along | closed, along}}};
        const auto if_own = [&](std::size_t axis, Half mask) { return owns_end[axis] ? mask : 0; };
        const Masks dropped{{{along | own | own << kWindow, if_own(1, along | own << kWindow)},
                             {if_own(2, along | own), if_own(1, if_own(2, along))}}};
        decltype(found_)::Adder add(found_);
        const int y0 = box.low[1], y1 = box.high[1], z0 = box.low[2], z1 = box.high[2];
        for (int k = z0; k <= z1; ++k) {
            const auto &kept_here = kept[k == z1], &dropped_here = dropped[k == z1];
            for (int j = y0; j <= y1; ++j) {
                const DrawnSite::Cut& cut = site.cut(j, k);
                const Half here = cut.kept_halves[half] & kept_here[j == y1];
                add(here | (cut.dropped_halves[half] & dropped_here[j == y1]),
                    {here, Edge::along_x(static_cast<unsigned>(origin), static_cast<unsigned>(j), static_cast<unsigned>(k))});
            }
        }
    }

    struct Row {
        Half kept;
        Edge start;
    };
    SetBits<Row, 2 * Site::kRows> found_;
    Array<Edge> kept_, dropped_;  // and room for one that is not
    std::size_t kept_size_ = 0, dropped_size_ = 0;
};

}  // namespace isocore::climbing
