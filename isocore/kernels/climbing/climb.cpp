// Follows T. Poston, T.-T. Wong, P.-A. Heng, "Multiresolution Isosurface Extraction with Adaptive Skeleton Climbing",
// Computer Graphics Forum 17(3), 1998 (Eurographics '98). README.md in this folder says where we depart and why.
#include "climbing/climb.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "climbing/boxes/bars.hpp"
#include "climbing/boxes/partition.hpp"
#include "climbing/crossings/gatherer.hpp"
#include "climbing/crossings/layout.hpp"
#include "climbing/drawer.hpp"
#include "climbing/error/late_mesh.hpp"
#include "climbing/error/splitting.hpp"
#include "climbing/triangles/in_order.hpp"
#include "common/parallel.hpp"
#include "common/set_bits.hpp"
#include "samples/sample_reader.hpp"
#include "samples/sample_types.hpp"
#include "samples/signs.hpp"

namespace isocore::climbing {
namespace {

// One extraction, step by step; climb() below is their order.
template <class Coordinate>
class Climb {
  public:
    Climb(const SampleReader& samples, const SignGrid& signs, const Options& options)
        : samples_(samples),
          signs_(signs),
          options_(options),
          bars_(lay_out_bars(signs_, options.block_size)),
          layout_(signs_, options.block_size, options.threads) {}

    void partition() {
        const Gatherer gatherer(samples_, options_);
        const bool bounded = std::isfinite(options_.max_error);
        auto boxes =
            partition_bars(signs_, options_.block_size, options_.threads, bounded ? &gatherer : nullptr, layout_);
        for (std::size_t n = 0; n < boxes.size(); ++n) static_cast<BarBoxes&>(bars_.bars[n]) = std::move(boxes[n]);
    }

    void number_and_place_vertices() {
        const std::size_t rows = signs_.dims[1], planes = signs_.dims[2];
        const std::size_t vertices = layout_.number();
        mesh_.vertices.reserve(3 * (vertices + vertices / kLateShare));
        mesh_.vertices.resize(3 * vertices);
        parallel_for(options_.threads, planes, [&](std::size_t k) {
            for (std::size_t start = 0; start < rows; start += layout_.strip) {
                if (layout_.vertices_in(start, k) == 0) continue;
                std::size_t crossing = layout_.first_crossing(start, k);
                Coordinate* out = mesh_.vertices.data() + 3 * layout_.vertex(crossing);
                for (std::size_t j = start; j < std::min(start + layout_.strip, rows); ++j) {
                    out = write_row_vertices(samples_, signs_, j, k, out, [&](auto axis, std::size_t w) {
                        const std::uint64_t crossed = crossed_edges(signs_, axis, j, k, w);
                        const std::size_t first = crossing;
                        crossing += static_cast<std::size_t>(std::popcount(crossed));
                        return layout_.kept(crossed, first);
                    });
                }
            }
        });
    }

    // Draws the bars that are stale, which are all of them at first.
    void draw() {
        // A loop of n vertices gives n - 2 triangles, and a vertex lies on at most four boxes. Room that is not used is
        // not touched.
        std::size_t most = 4 * (mesh_.vertices.size() / 3);
        for (const Bar& bar : bars_.bars) most -= 2 * bar.highrices;
        mesh_.triangles.resize(3 * most);
        InOrder triangles(bars_.bars.size(), most_early(), mesh_.triangles);
        draw_stale([&](std::size_t n, const auto& draw_bar) {
            try {
                triangles.begin(n);
                draw_bar([&](std::span<const std::int32_t> part) { triangles.put(n, part); });
                triangles.end(n);
            } catch (...) {
                triangles.give_up();
                throw;
            }
        });
        mesh_.triangles.resize(3 * place_bars(bars_));
    }

    // Halves the boxes that break the bound. False if there are none.
    bool split() {
        const std::vector<LateHighRice> late = split_broken(signs_, bars_);
        if (late.empty()) return false;
        insert_vertices(keep_late(signs_, late, options_.block_size, layout_));

        std::vector<std::size_t> before;
        for (const Bar& bar : bars_.bars) before.push_back(bar.first_triangle);
        Redrawn redrawn(bars_.bars.size());
        for (std::size_t n = 0; n < redrawn.size(); ++n) {
            if (bars_.bars[n].stale) redrawn[n].emplace();
        }
        draw_stale([&](std::size_t n, const auto& draw_bar) {
            draw_bar([&](std::span<const std::int32_t> part) {
                redrawn[n]->insert(redrawn[n]->end(), part.begin(), part.end());
            });
        });
        const std::size_t size = 3 * place_bars(bars_);
        mesh_.triangles.resize(std::max(mesh_.triangles.size(), size));
        move_triangles(before, redrawn, bars_, mesh_.triangles);
        mesh_.triangles.resize(size);
        return true;
    }

    Mesh<Coordinate> take() {
        mesh_.facts = sum_facts(bars_);
        mesh_.facts.crossings = layout_.crossings();
        return std::move(mesh_);
    }

  private:
    void insert_vertices(std::vector<LateVertex> late) {
        layout_.number();
        for (LateVertex& vertex : late) vertex.vertex = layout_.vertex(vertex.crossing);
        make_room(late, mesh_.vertices);
        for (const LateVertex& vertex : late) {
            const auto& [i, j, k] = vertex.at;
            CrossedWords edge;
            edge.add(1, {vertex.axis, i});
            samples_.write_vertices(j, k, edge, mesh_.vertices.data() + 3 * vertex.vertex);
        }
        parallel_for(options_.threads, bars_.bars.size(), [&](std::size_t n) {
            const Bar& bar = bars_.bars[n];
            if (!bar.stale) renumber(late, {mesh_.triangles.data() + 3 * bar.first_triangle, 3 * bar.triangles});
        });
    }

    // Numbers that may be kept aside: little beside the samples, but enough for all threads to be at work.
    std::size_t most_early() const {
        std::size_t samples = 1;
        for (const std::size_t dim : signs_.dims) samples *= dim - 2 * signs_.pad;
        return std::max<std::size_t>(samples / 512, 8192 * static_cast<std::size_t>(std::max(options_.threads, 1)));
    }

    // Room is left for so large a share of vertices that late halvings may add: growing would need room twice.
    static constexpr std::size_t kLateShare = 16;

    // Calls visit(number, draw_bar) for each bar that is stale, from any thread; draw_bar(put) draws it and calls
    // put(triangles) for some after the other.
    template <class Visit>
    void draw_stale(const Visit& visit) {
        const PlacedVertices vertices(mesh_.vertices.data());
        const auto make = [&] { return std::make_unique<Drawer>(samples_, signs_, layout_, options_, vertices); };
        parallel_for(options_.threads, bars_.bars.size(), make,
                     [&](const std::unique_ptr<Drawer>& drawer, std::size_t n) {
                         if (bars_.bars[n].stale)
                             visit(n, [&](const auto& put) { drawer->draw(bars_, n, bars_.bars[n], put); });
                     });
    }

    const SampleReader& samples_;
    const SignGrid& signs_;
    const Options& options_;
    Bars bars_;
    Layout layout_;
    Mesh<Coordinate> mesh_;
};

}  // namespace

template <class Sample, class Coordinate>
Mesh<Coordinate> climb(GridView<Sample> samples, const Options& options, const Sample* ranges) {
    if (*std::min_element(samples.dims.begin(), samples.dims.end()) < 2) {
        throw std::invalid_argument("climbing needs two samples per axis");
    }
    const SignGrid signs = classify(samples, options.isovalue, options.below, options.capped, options.threads, ranges);
    const SamplesOf<Sample> reader(samples, signs, options.isovalue);
    Climb<Coordinate> work(reader, signs, options);
    work.partition();
    work.number_and_place_vertices();
    work.draw();
    while (work.split()) {}
    return work.take();
}

#define ISOCORE_INSTANTIATE(Sample)                                                             \
    template Mesh<float> climb<Sample, float>(GridView<Sample>, const Options&, const Sample*); \
    template Mesh<double> climb<Sample, double>(GridView<Sample>, const Options&, const Sample*);
ISOCORE_FOR_EACH_SAMPLE_TYPE(ISOCORE_INSTANTIATE)
#undef ISOCORE_INSTANTIATE

}  // namespace isocore::climbing
