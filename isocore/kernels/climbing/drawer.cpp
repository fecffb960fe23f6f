#include "climbing/drawer.hpp"

#include <array>
#include <bit>

#include "climbing/boxes/halvings.hpp"
#include "tables/cell_loops.hpp"

namespace isocore::climbing {
namespace {

constexpr std::size_t kMostOfCell = cell_loops::Case{}.edges.size() / 3;  // triangles

// The vertices on the twelve edges of cell x of a row, in the order of cube.hpp. row, right, up and far are the rows of
// edges at (j, k), (j + 1, k), (j, k + 1) and (j + 1, k + 1). The numbers of edges that are not crossed mean nothing.
std::array<std::uint32_t, 12> edge_numbers(const DrawnSite::KeptRow& row, const DrawnSite::KeptRow& right,
                                           const DrawnSite::KeptRow& up, const DrawnSite::KeptRow& far, int x) {
    using KeptRow = DrawnSite::KeptRow;
    const std::uint64_t before = (std::uint64_t{1} << x) - 1;
    const auto number = [&](const KeptRow& from, std::size_t axis) {
        return from.first_vertex[axis] + static_cast<std::uint32_t>(std::popcount(from.kept[axis] & before));
    };
    std::array<std::uint32_t, 12> out{number(row, 0), number(right, 0), number(up, 0), number(far, 0)};
    // The edges along y or z at samples x and x + 1: the second vertex follows the first, if there is a first.
    const auto two = [&](std::size_t edge, const KeptRow& from, std::size_t axis) {
        out[edge] = number(from, axis);
        out[edge + 1] = out[edge] + static_cast<std::uint32_t>(from.kept[axis] >> x & 1);
    };
    two(4, row, 1);
    two(6, up, 1);
    two(8, row, 2);
    two(10, right, 2);
    return out;
}

}  // namespace

Drawer::Drawer(const SampleReader& samples, const SignGrid& signs, const Layout& layout, const Options& options,
               const PlacedVertices& vertices)
    : samples_(samples),
      signs_(signs),
      layout_(layout),
      site_(options.block_size),
      rices_(options.block_size),
      disks_(samples, signs, options, vertices) {}

void Drawer::draw(const Bars& bars, std::size_t number, Bar& bar, const Put& put) {
    bar.triangles = 0;
    bar.ambiguous_faces = bar.ambiguous_cells = 0;
    bar.in_voxels = bar.in_world = {};
    bar.broken.clear();
    bar.stale = false;
    if (bar.blocks == 0) return;
    const auto [start, y, z] = bars.origin(number);
    site_.begin(signs_, layout_, y, z);
    HalvingsReader halvings(bar.halvings);
    disks_.begin_bar();
    for (std::size_t x = start; x + 1 < signs_.dims[0]; x += bars.block_size) {
        const Fate fate = halvings.next_block();
        if (fate == Fate::nothing) continue;
        site_.load(x);
        rices_.read(fate, halvings);
        disks_.draw(site_, rices_.boxes(), triangles_, bar);
        rices_.visit_cells(site_, [&](int j, int k, std::uint64_t cells) { draw_cells(bar, j, k, cells); });
        put(triangles_.vertices());
        bar.triangles += triangles_.size();
        triangles_.clear();
    }
    disks_.end_bar(bar);
}

// Draws single cells of row (j, k), a bit each, by marching cubes' table.
void Drawer::draw_cells(Bar& bar, int j, int k, std::uint64_t cells) {
    std::int32_t* out = triangles_.reserve(kMostOfCell * static_cast<std::size_t>(std::popcount(cells)));
    for (std::uint64_t left = cells; left; left &= left - 1) {
        const int x = std::countr_zero(left);
        const auto pair = [&](int right, int up) {
            return static_cast<unsigned>(site_.row(j + right, k + up).signs >> x & 3);
        };
        const unsigned corners = pair(0, 0) | pair(1, 0) << 2 | pair(0, 1) << 4 | pair(1, 1) << 6;
        const auto& entry = cell_loops::kTable.corners[corners];
        const unsigned decisions = entry.ambiguous ? decide_faces(bar, corners, entry.ambiguous, x, j, k) : 0;
        const auto numbers = edge_numbers(site_.kept_row(j, k), site_.kept_row(j + 1, k), site_.kept_row(j, k + 1),
                                          site_.kept_row(j + 1, k + 1), x);
        const auto& drawn = cell_loops::kTable.cases[entry.first + decisions];
        for (unsigned n = 0; n < 3u * drawn.triangles; ++n) *out++ = static_cast<std::int32_t>(numbers[drawn.edges[n]]);
    }
    triangles_.end_at(out);
}

// Decides the ambiguous faces of cell (i, j, k), a bit each in `ambiguous`, and counts them.
unsigned Drawer::decide_faces(Bar& bar, unsigned corners, unsigned ambiguous, int i, int j, int k) const {
    ++bar.ambiguous_cells;
    bar.ambiguous_faces += static_cast<std::size_t>(std::popcount(ambiguous));
    const Dims cell{site_.origin[0] + static_cast<std::size_t>(i), site_.origin[1] + static_cast<std::size_t>(j),
                    site_.origin[2] + static_cast<std::size_t>(k)};
    return samples_.decide_faces(corners, cell);
}

}  // namespace isocore::climbing
