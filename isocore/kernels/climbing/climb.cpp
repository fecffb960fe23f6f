// Follows T. Poston, T.-T. Wong, P.-A. Heng, "Multiresolution Isosurface Extraction with Adaptive Skeleton Climbing",
// Computer Graphics Forum 17(3), 1998 (Eurographics '98). README.md in this folder says where we depart and why.
#include "climbing/climb.hpp"

#include <algorithm>
#include <atomic>
#include <bit>
#include <stdexcept>
#include <vector>

#include "climbing/deviation.hpp"
#include "climbing/flatness.hpp"
#include "climbing/high_rice.hpp"
#include "climbing/layout.hpp"
#include "climbing/padi.hpp"
#include "climbing/partition.hpp"
#include "climbing/polygon.hpp"
#include "common/decider.hpp"
#include "common/edge_vertices.hpp"
#include "common/parallel.hpp"
#include "common/signs.hpp"

namespace isocore::climbing {
namespace {

using cell_loops::kTable;

// A row of blocks along the first axis: the unit of parallel work.
struct Bar {
    std::vector<HighRice> boxes;
    std::size_t blocks_visited = 0;
    std::size_t first_triangle = 0, triangles = 0;
    std::size_t ambiguous_faces = 0, ambiguous_cells = 0;
    std::size_t split_again = 0;
    Deviation in_voxels, in_world;
};

struct Bars {
    Dims blocks;
    std::size_t block_size;
    std::vector<Bar> bars;  // [z][y]
    std::size_t triangles_at_most = 0;
};

Bars lay_out_bars(const SignGrid& signs, int block_size) {
    if (block_size < 1 || block_size > 32 || !std::has_single_bit(static_cast<unsigned>(block_size))) {
        throw std::invalid_argument("the block size must be 1, 2, 4, 8, 16 or 32");
    }
    Bars out;
    out.block_size = static_cast<std::size_t>(block_size);
    for (std::size_t a = 0; a < 3; ++a) out.blocks[a] = (signs.dims[a] - 2) / out.block_size + 1;
    out.bars.resize(out.blocks[1] * out.blocks[2]);
    return out;
}

// Marks every box in the layout. Layers of bars meet in one plane of samples, so they take turns.
void mark_all(const Bars& bars, int threads, Layout& layout) {
    const std::size_t layers = bars.blocks[2];
    for (std::size_t parity = 0; parity < 2; ++parity) {
        parallel_for(threads, (layers + 1 - parity) / 2, [&](std::size_t n) {
            const std::size_t first = (2 * n + parity) * bars.blocks[1];
            for (std::size_t bar = first; bar < first + bars.blocks[1]; ++bar) {
                for (const HighRice& box : bars.bars[bar].boxes) layout.mark(box);
            }
        });
    }
}

// How many triangles a bar draws at most: a loop of n vertices gives n - 2, and a vertex lies on at most four boxes,
// two of one bar if it lies on the bar's side, and one on the bar's edge. Only cells of several loops stay below.
void bound_triangles(const SignGrid& signs, const Layout& layout, Bars& bars) {
    const std::size_t size = bars.block_size, last_j = signs.dims[1] - 1, last_k = signs.dims[2] - 1;
    std::size_t next = 0;
    for (std::size_t bar = 0; bar < bars.bars.size(); ++bar) {
        const std::size_t j0 = size * (bar % bars.blocks[1]), j1 = std::min(j0 + size, last_j);
        const std::size_t k0 = size * (bar / bars.blocks[1]), k1 = std::min(k0 + size, last_k);
        std::size_t corners = 0;
        for (std::size_t k = k0; k <= k1; ++k) {
            for (std::size_t j = j0; j <= j1; ++j) {
                const std::size_t sides_j = j == j0 || j == j1 ? 1 : 2, sides_k = k == k0 || k == k1 ? 1 : 2;
                const auto counts = layout.row_counts(j, k);
                corners += counts[0] * sides_j * sides_k;
                if (j < j1) corners += counts[1] * 2 * sides_k;
                if (k < k1) corners += counts[2] * 2 * sides_j;
            }
        }
        bars.bars[bar].first_triangle = next;
        next += corners - 2 * bars.bars[bar].boxes.size();
    }
    bars.triangles_at_most = next;
}

template <class Sample, class Coordinate>
class Drawer {
  public:
    Drawer(const GridView<Sample>& samples, const SignGrid& signs, const Layout& layout, double isovalue, const Coordinate* vertices)
        : samples_(samples), signs_(signs), layout_(layout), isovalue_(isovalue), vertices_(vertices), walk_(signs, layout) {}

    std::int32_t* draw(Bar& bar, std::int32_t* out) {
        for (const HighRice& box : bar.boxes) {
            const unsigned corners = box_corners(signs_, box);
            out = box.is_cell() ? draw_cell(bar, box, corners, out) : draw_disk(box, corners, out);
        }
        return out;
    }

  private:
    std::int32_t* draw_cell(Bar& bar, const HighRice& box, unsigned corners, std::int32_t* out) {
        const auto& entry = kTable.corners[corners];
        unsigned decisions = 0;
        if (entry.ambiguous) {
            const Dims cell{static_cast<std::size_t>(box.low[0]), static_cast<std::size_t>(box.low[1]), static_cast<std::size_t>(box.low[2])};
            decisions = decide_faces(samples_, signs_.pad, isovalue_, corners, cell);
            ++bar.ambiguous_cells;
            bar.ambiguous_faces += static_cast<std::size_t>(std::popcount(unsigned{entry.ambiguous}));
        }
        const auto& drawn = kTable.cases[entry.first + decisions];
        for (unsigned n = 0; n < 3u * drawn.triangles; ++n) {
            const int edge = drawn.edges[n], corner = cube::low_corner(edge);
            *out++ = vertex({edge / 4, {box.low[0] + (corner & 1), box.low[1] + (corner >> 1 & 1), box.low[2] + (corner >> 2)}, 0});
        }
        return out;
    }

    std::int32_t* draw_disk(const HighRice& box, unsigned corners, std::int32_t* out) {
        walk_.loop(box, kRims[corners], loop_);
        polygon_.corners.clear();
        for (const RimEdge& edge : loop_) {
            const std::int32_t number = vertex(edge);
            const Coordinate* place = vertices_ + 3 * static_cast<std::size_t>(number);
            polygon_.corners.push_back({{place[0], place[1], place[2]}, edge.faces, number});
        }
        polygon_.cut([&](std::size_t a, std::size_t b, std::size_t c) {
            for (const std::size_t n : {a, b, c}) *out++ = polygon_.corners[n].vertex;
        });
        return out;
    }

    std::int32_t vertex(const RimEdge& edge) const {
        return static_cast<std::int32_t>(layout_.vertex(edge.axis, static_cast<std::size_t>(edge.at[0]),
                                                        static_cast<std::size_t>(edge.at[1]), static_cast<std::size_t>(edge.at[2])));
    }

    const GridView<Sample>& samples_;
    const SignGrid& signs_;
    const Layout& layout_;
    double isovalue_;
    const Coordinate* vertices_;
    RimWalk walk_;
    std::vector<RimEdge> loop_;
    Polygon polygon_;
};

// Cuts a box that holds a disk down to boxes that do: its parts are as simple, but their corners need not show it.
void halve(const SignGrid& signs, const HighRice& box, std::vector<HighRice>& out) {
    std::size_t axis = 0;
    for (std::size_t a = 1; a < 3; ++a) {
        if (box.high[a] - box.low[a] > box.high[axis] - box.low[axis]) axis = a;
    }
    const std::int32_t middle = (box.low[axis] + box.high[axis]) / 2;
    HighRice below = box, above = box;
    below.high[axis] = above.low[axis] = middle;
    for (const HighRice& half : {below, above}) {
        const Content content = kContents[box_corners(signs, half)];
        if (content == Content::nothing) continue;
        if (content == Content::disk || half.is_cell()) out.push_back(half);
        else halve(signs, half, out);
    }
}

// Measures all boxes of a bar and halves those that break the bound. Returns whether there were any.
template <class Sample, class Coordinate>
bool keep_bound(const GridView<Sample>& samples, const SignGrid& signs, const Layout& layout, const Options& options, Bar& bar) {
    Surveyor<Sample, Coordinate> surveyor(samples, signs, layout, options.isovalue);
    const std::array<Point, 2> scales{Point{1, 1, 1}, options.spacing};
    std::vector<HighRice> kept;
    std::size_t broken = 0;
    bar.in_voxels = bar.in_world = {};
    for (const HighRice& box : bar.boxes) {
        if (box.is_cell()) {
            kept.push_back(box);
            continue;
        }
        const auto [in_voxels, in_world] = surveyor.survey(box, scales);
        if ((options.in_world ? in_world : in_voxels).max > options.max_error) {
            ++broken;
            halve(signs, box, kept);
        } else {
            kept.push_back(box);
            add(bar.in_voxels, in_voxels);
            add(bar.in_world, in_world);
        }
    }
    bar.boxes = std::move(kept);
    bar.split_again += broken;
    return broken != 0;
}

std::size_t count_crossings(const SignGrid& signs, std::size_t j, std::size_t k) {
    std::size_t count = 0;
    for (int axis = 0; axis < 3; ++axis) {
        for (std::size_t w = 0; w < signs.words; ++w) count += static_cast<std::size_t>(std::popcount(crossed_edges(signs, axis, j, k, w)));
    }
    return count;
}

// Closes the gaps that the bound left between the bars' triangles.
void close_gaps(const Bars& bars, Array<std::int32_t>& triangles) {
    std::size_t end = 0;
    for (const Bar& bar : bars.bars) {
        if (bar.first_triangle != end) {
            const auto from = triangles.begin() + static_cast<std::ptrdiff_t>(3 * bar.first_triangle);
            std::copy(from, from + static_cast<std::ptrdiff_t>(3 * bar.triangles), triangles.begin() + static_cast<std::ptrdiff_t>(3 * end));
        }
        end += bar.triangles;
    }
    triangles.resize(3 * end);
}

Facts sum_facts(const Bars& bars) {
    Facts facts;
    facts.blocks = bars.blocks[0] * bars.blocks[1] * bars.blocks[2];
    for (const Bar& bar : bars.bars) {
        facts.highrices += bar.boxes.size();
        facts.blocks_visited += bar.blocks_visited;
        facts.ambiguous_faces += bar.ambiguous_faces;
        facts.ambiguous_cells += bar.ambiguous_cells;
        facts.split_again += bar.split_again;
        add(facts.in_voxels, bar.in_voxels);
        add(facts.in_world, bar.in_world);
    }
    return facts;
}

}  // namespace

template <class Sample, class Coordinate>
Mesh<Coordinate> climb(GridView<Sample> samples, const Options& options) {
    if (*std::min_element(samples.dims.begin(), samples.dims.end()) < 2) {
        throw std::invalid_argument("climbing needs two samples per axis");
    }
    const SignGrid signs = classify(samples, options.isovalue, options.below, options.capped, options.threads);
    Bars bars = lay_out_bars(signs, options.block_size);
    const bool bounded = std::isfinite(options.max_error);
    const Flatness<Sample> flatness(samples, signs, options.isovalue, options.max_error, options.in_world ? options.spacing : Point{1, 1, 1});
    parallel_for(options.threads, bars.bars.size(), [&](std::size_t n) {
        Bar& bar = bars.bars[n];
        bar.blocks_visited = partition_bar(signs, options.block_size, n % bars.blocks[1], n / bars.blocks[1],
                                           bounded ? &flatness : nullptr, bar.boxes);
    });

    Layout layout(signs);
    const std::size_t rows = signs.dims[1], planes = signs.dims[2];
    for (bool settled = false; !settled;) {
        mark_all(bars, options.threads, layout);
        parallel_for(options.threads, planes, [&](std::size_t k) {
            for (std::size_t j = 0; j < rows; ++j) layout.count_row(j, k);
        });
        std::atomic<bool> broken = false;
        parallel_for(options.threads, bars.bars.size(), [&](std::size_t n) {
            if (keep_bound<Sample, Coordinate>(samples, signs, layout, options, bars.bars[n])) broken = true;
        });
        settled = !broken;
    }
    Mesh<Coordinate> mesh;
    mesh.vertices.resize(3 * layout.number());
    bound_triangles(signs, layout, bars);
    parallel_for(options.threads, planes, [&](std::size_t k) {
        for (std::size_t j = 0; j < rows; ++j) {
            Coordinate* out = mesh.vertices.data() + 3 * std::size_t{layout.base(j, k)[0]};
            write_row_vertices(samples, signs, options.isovalue, j, k, out, [&](int axis, std::size_t w) { return layout.kept(axis, w, j, k); });
        }
    });
    mesh.triangles.resize(3 * bars.triangles_at_most);
    parallel_for(options.threads, bars.bars.size(), [&](std::size_t n) {
        Bar& bar = bars.bars[n];
        Drawer<Sample, Coordinate> drawer(samples, signs, layout, options.isovalue, mesh.vertices.data());
        std::int32_t* const first = mesh.triangles.data() + 3 * bar.first_triangle;
        bar.triangles = static_cast<std::size_t>(drawer.draw(bar, first) - first) / 3;
    });
    close_gaps(bars, mesh.triangles);
    mesh.facts = sum_facts(bars);
    for (std::size_t k = 0; k < planes; ++k) {
        for (std::size_t j = 0; j < rows; ++j) mesh.facts.crossings += count_crossings(signs, j, k);
    }
    return mesh;
}

#define ISOCORE_INSTANTIATE(Sample)                                              \
    template Mesh<float> climb<Sample, float>(GridView<Sample>, const Options&); \
    template Mesh<double> climb<Sample, double>(GridView<Sample>, const Options&);
ISOCORE_INSTANTIATE(std::uint8_t)
ISOCORE_INSTANTIATE(std::int8_t)
ISOCORE_INSTANTIATE(std::uint16_t)
ISOCORE_INSTANTIATE(std::int16_t)
ISOCORE_INSTANTIATE(std::uint32_t)
ISOCORE_INSTANTIATE(std::int32_t)
ISOCORE_INSTANTIATE(float)
ISOCORE_INSTANTIATE(double)
#undef ISOCORE_INSTANTIATE

}  // namespace isocore::climbing
