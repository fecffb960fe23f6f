#include "climbing/extraction.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>

#include "climbing/boxes/partition.hpp"
#include "climbing/crossings/gatherer.hpp"
#include "climbing/error/late_mesh.hpp"
#include "climbing/triangles/in_order.hpp"
#include "climbing/triangles/placed_vertices.hpp"
#include "common/parallel.hpp"
#include "samples/crossed_edges.hpp"
#include "samples/row_vertices.hpp"

namespace isocore::climbing {
namespace {

// One vertex in so many may be added by late halvings without growing the array, which would need its memory twice.
constexpr std::size_t kLateShare = 16;

}  // namespace

template <class Coordinate>
Extraction<Coordinate>::Extraction(const SampleReader& samples, const SignGrid& signs, const Options& options,
                                   const Slopes<Coordinate>& slopes)
    : samples_(samples),
      signs_(signs),
      options_(options),
      slopes_(slopes),
      bars_(lay_out_bars(signs_, options.block_size)),
      layout_(signs_, options.block_size, options.threads) {}

template <class Coordinate>
void Extraction<Coordinate>::partition() {
    const Gatherer gatherer(samples_, options_);
    const bool bounded = std::isfinite(options_.max_error);
    auto boxes = partition_bars(signs_, options_.block_size, options_.threads, bounded ? &gatherer : nullptr, layout_);
    for (std::size_t n = 0; n < boxes.size(); ++n) static_cast<BarBoxes&>(bars_.bars[n]) = std::move(boxes[n]);
}

template <class Coordinate>
void Extraction<Coordinate>::number_and_place_vertices() {
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
    find_directions();
}

template <class Coordinate>
void Extraction<Coordinate>::find_directions() {
    if (!slopes_) return;
    directions_ = slopes_(mesh_.vertices);
    for (float& component : directions_) {
        if (std::isnan(component)) component = 0;  // then all triangles there are equally tilted
    }
}

template <class Coordinate>
void Extraction<Coordinate>::draw() {
    // A loop of n vertices gives n - 2 triangles, and a vertex lies on at most four boxes: this bounds their number.
    // Pages of the array that are never written to take no memory.
    std::size_t most = 4 * (mesh_.vertices.size() / 3);
    for (const Bar& bar : bars_.bars) most -= 2 * bar.highrices;
    mesh_.triangles.resize(3 * most);
    InOrder triangles(bars_.bars.size(), most_early(), mesh_.triangles);
    draw_stale([&](std::size_t n, const DrawBar& draw_bar) {
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

template <class Coordinate>
bool Extraction<Coordinate>::split() {
    const std::vector<LateHighRice> late = split_broken(signs_, bars_);
    if (late.empty()) return false;
    insert_vertices(keep_late(signs_, late, options_.block_size, layout_));

    std::vector<std::size_t> before;
    for (const Bar& bar : bars_.bars) before.push_back(bar.first_triangle);
    Redrawn redrawn(bars_.bars.size());
    for (std::size_t n = 0; n < redrawn.size(); ++n) {
        if (bars_.bars[n].stale) redrawn[n].emplace();
    }
    draw_stale([&](std::size_t n, const DrawBar& draw_bar) {
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

template <class Coordinate>
Mesh<Coordinate> Extraction<Coordinate>::take() {
    mesh_.facts = sum_facts(bars_);
    mesh_.facts.crossings = layout_.crossings();
    return std::move(mesh_);
}

// Gives late vertices their numbers and places, and renumbers the triangles of the bars that are not drawn again.
template <class Coordinate>
void Extraction<Coordinate>::insert_vertices(std::vector<LateVertex> late) {
    layout_.number();
    for (LateVertex& vertex : late) vertex.vertex = layout_.vertex(vertex.crossing);
    make_room(late, mesh_.vertices);
    for (const LateVertex& vertex : late) {
        const auto& [i, j, k] = vertex.at;
        CrossedWords edge;
        edge.add(1, {vertex.axis, i});
        samples_.write_vertices(j, k, edge, mesh_.vertices.data() + 3 * vertex.vertex);
    }
    find_directions();
    parallel_for(options_.threads, bars_.bars.size(), [&](std::size_t n) {
        const Bar& bar = bars_.bars[n];
        if (!bar.stale) renumber(late, {mesh_.triangles.data() + 3 * bar.first_triangle, 3 * bar.triangles});
    });
}

// How many vertex numbers InOrder may keep aside: little beside the samples, but enough for all threads to be at work.
template <class Coordinate>
std::size_t Extraction<Coordinate>::most_early() const {
    std::size_t samples = 1;
    for (const std::size_t dim : signs_.dims) samples *= dim - 2 * signs_.pad;
    return std::max<std::size_t>(samples / 512, 8192 * static_cast<std::size_t>(std::max(options_.threads, 1)));
}

// Calls visit(number, draw_bar) for each stale bar, from any thread; draw_bar(put) draws that bar, see Drawer::draw. At
// first all bars are stale.
template <class Coordinate>
void Extraction<Coordinate>::draw_stale(const std::function<void(std::size_t, const DrawBar&)>& visit) {
    const PlacedVertices vertices(mesh_.vertices.data(), slopes_ ? directions_.data() : nullptr);
    const auto make = [&] { return std::make_unique<Drawer>(samples_, signs_, layout_, options_, vertices); };
    parallel_for(options_.threads, bars_.bars.size(), make, [&](const std::unique_ptr<Drawer>& drawer, std::size_t n) {
        if (bars_.bars[n].stale) visit(n, [&](const Drawer::Put& put) { drawer->draw(bars_, n, bars_.bars[n], put); });
    });
}

template class Extraction<float>;
template class Extraction<double>;

}  // namespace isocore::climbing
