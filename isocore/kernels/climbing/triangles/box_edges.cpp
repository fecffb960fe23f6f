// box_edges.cpp - Two steps, both without a branch that depends on where the surface runs: add() cuts a box's share out
// of each row's window, find() lists the set bits of all those windows.
#include "climbing/triangles/box_edges.hpp"

#include <algorithm>
#include <bit>
#include <utility>

namespace isocore::climbing {
namespace {

using Window = DrawnSite::Window;
constexpr int kAxis = DrawnSite::kWindowSamples;  // bits for each axis of a window
constexpr std::size_t kManyWindows = 256;         // once this many wait, they are listed

// The steps from the edge of a window's bit 0 to the edge of each bit.
constexpr std::array<Edge, 64> kSteps = [] {
    std::array<Edge, 64> steps{};
    for (int bit = 0; bit < 3 * kAxis; ++bit) {
        steps[static_cast<std::size_t>(bit)] =
            Edge::along_x(static_cast<unsigned>(bit % kAxis), 0, 0).of_axis(bit / kAxis);
    }
    return steps;
}();

// Which bits of a window are a box's, by whether the row is in the box's last plane (along z) and whether it is the
// last row of its plane (along y): mask[last plane][last row].
//
// For example, the box from (1, 0, 0) to (4, 2, 1) has edges along x at samples 1, 2, 3 of each of its rows, and edges
// along y and along z at samples 1, 2, 3, 4. No edge along y starts in a plane's last row, nor one along z in the last
// plane, as it would leave the box. As bits | z | y | x |, the five lowest of each axis, highest sample first:
//
//                     row 0 or 1              row 2, the last one
//     plane 0         | 11110 | 11110 | 01110 |   | 11110 | 00000 | 01110 |
//     plane 1, last   | 00000 | 11110 | 01110 |   | 00000 | 00000 | 01110 |
//
// The masks of dropped edges leave out the high faces where there is a box beyond: there sample 4 along y and z, all of
// row 2, and all of plane 1.
using Masks = std::array<std::array<Window, 2>, 2>;
struct BoxMasks {
    Masks kept, dropped;

    // For the samples of the box from its low end up to `end`, in the window that starts at sample `origin`.
    BoxMasks(const DrawnSite& site, const HighRice& box, int origin, int end) {
        std::array<bool, 3> owns_end;  // is there no box beyond?
        for (std::size_t a = 0; a < 3; ++a) owns_end[a] = box.high[a] == site.cells[a] && site.ends_grid[a];
        const int start = std::max<int>(box.low[0] - origin, 0);
        const auto up_to = [&](int sample) { return (Window{2} << (sample - origin)) - (Window{1} << start); };
        const int last_own = end == box.high[0] && !owns_end[0] ? end - 1 : end;
        const Window x = up_to(std::min(end, box.high[0] - 1));
        const Window y = up_to(end) << kAxis, z = y << kAxis;
        const Window own_y = up_to(last_own) << kAxis, own_z = own_y << kAxis;
        const auto if_own = [&](std::size_t axis, Window mask) { return owns_end[axis] ? mask : 0; };
        kept = {{{x | y | z, x | z}, {x | y, x}}};
        dropped = {{{x | own_y | own_z, if_own(1, x | own_z)}, {if_own(2, x | own_y), if_own(1, if_own(2, x))}}};
    }
};

}  // namespace

BoxEdges::BoxEdges(int block_size) {
    const auto samples = static_cast<std::size_t>(block_size + 1),
               of_row = std::size_t{block_size > DrawnSite::kWindowStep ? 2u : 1u};
    windows_.resize(kManyWindows + of_row * samples * samples + 1);
    windows_end_ = windows_.data();
    for (Array<BoxEdge>* edges : {&kept_, &dropped_}) edges->resize(kMostEdges + 1);
    clear();
}

void BoxEdges::clear() {
    size_ = ligns_ = 0;
    kept_end_ = kept_.data();
    dropped_end_ = dropped_.data();
}

void BoxEdges::add(const DrawnSite& site, const HighRice& box) {
    boxes_[size_] = box;
    ligns_ += count_ligns(box);
    counts_[size_ + 1] = counts_[size_];
    const int middle = DrawnSite::kWindowStep;
    if (box.low[0] < middle)
        add_window(site, box, 0, std::min<int>(box.high[0], box.high[0] > middle ? middle - 1 : middle));
    if (box.high[0] > middle) add_window(site, box, 1, box.high[0]);
    ++size_;
    if (windows_end_ > windows_.data() + kManyWindows) find();
}

// Adds, of every row of the box, the edges in one window that start at samples up to `end`.
void BoxEdges::add_window(const DrawnSite& site, const HighRice& box, std::size_t window, int end) {
    const int origin = window ? DrawnSite::kWindowStep : 0;
    const BoxMasks masks(site, box, origin, end);
    Counts counts = counts_[size_ + 1];
    WordAdder<Tag> add(windows_end_);
    const auto add_row = [&](const DrawnSite::KeptRow& row, Window kept_mask, Window dropped_mask, BoxEdge first) {
        const Window kept = row.kept_windows[window] & kept_mask, dropped = row.dropped_windows[window] & dropped_mask;
        counts.kept += static_cast<std::uint32_t>(std::popcount(kept));
        counts.dropped += static_cast<std::uint32_t>(std::popcount(dropped));
        add(kept | dropped, {kept, first});
    };
    const auto rows = static_cast<unsigned>(box.length(1)), planes = static_cast<unsigned>(box.length(2));
    const auto add_plane = [&](unsigned k, const std::array<Window, 2>& kept, const std::array<Window, 2>& dropped) {
        const DrawnSite::KeptRow* row = &site.kept_row(box.low[1], static_cast<int>(box.low[2] + k));
        BoxEdge first(Edge::along_x(static_cast<unsigned>(origin), box.low[1], box.low[2] + k), size_);
        for (unsigned j = 0; j < rows; ++j, ++row, first = first.further(Edge::along_x(0, 1, 0)))
            add_row(*row, kept[0], dropped[0], first);
        add_row(*row, kept[1], dropped[1], first);
    };
    for (unsigned k = 0; k < planes; ++k) add_plane(k, masks.kept[0], masks.dropped[0]);
    add_plane(planes, masks.kept[1], masks.dropped[1]);
    counts_[size_ + 1] = counts;
}

void BoxEdges::find() {
    BoxEdge *kept = kept_end_, *dropped = dropped_end_;
    visit_bits(windows_.data(), std::exchange(windows_end_, windows_.data()), [&](const Tag& tag, int bit) {
        // Both lists are written to, and only the end of the right one moves: no branch.
        *kept = *dropped = tag.start.further(kSteps[static_cast<std::size_t>(bit)]);
        const std::size_t is_kept = tag.kept >> bit & 1;
        kept += is_kept;
        dropped += 1 - is_kept;
    });
    kept_end_ = kept;
    dropped_end_ = dropped;
}

}  // namespace isocore::climbing
