// Follows T. Poston, T.-T. Wong, P.-A. Heng, "Multiresolution Isosurface Extraction with Adaptive Skeleton Climbing",
// Computer Graphics Forum 17(3), 1998 (Eurographics '98). README.md in this folder says where we depart and why.
#include "climbing/climb.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "climbing/bars.hpp"
#include "climbing/crossings.hpp"
#include "climbing/drawer.hpp"
#include "climbing/layout.hpp"
#include "climbing/partition.hpp"
#include "climbing/splitting.hpp"
#include "common/edge_vertices.hpp"
#include "common/parallel.hpp"
#include "common/signs.hpp"

namespace isocore::climbing {
namespace {

template <class Sample>
class Gatherer final : public Judge {
  public:
    Gatherer(const GridView<Sample>& samples, const SignGrid& signs, const Options& options)
        : Judge(options.max_error, options.in_world ? options.spacing : Point{1, 1, 1}),
          samples_(samples),
          signs_(signs),
          isovalue_(options.isovalue) {}

    void gather(const Dims& origin, const std::array<int, 3>& cells, const std::uint64_t* rows, int stride, Clouds& clouds) const override {
        const HighRice block{{}, {static_cast<std::uint8_t>(cells[0]), static_cast<std::uint8_t>(cells[1]), static_cast<std::uint8_t>(cells[2])}};
        const auto edges = [&](int axis, int j, int k) {
            const std::uint64_t* row = rows + j + stride * k;
            return axis == 0 ? row[0] ^ row[0] >> 1 : row[0] ^ row[axis == 1 ? 1 : stride];
        };
        std::size_t count = 0;
        for (int k = 0; k <= cells[2]; ++k) {
            for (int j = 0; j <= cells[1]; ++j) {
                for (int axis = 0; axis < 3; ++axis) {
                    if ((axis == 1 && j == cells[1]) || (axis == 2 && k == cells[2])) continue;
                    count += static_cast<std::size_t>(std::popcount(edges(axis, j, k)));
                }
            }
        }
        clouds.reset(count, kLevels);
        visit_edges(block, cells, edges, [&](int axis, const Place& at) {
            float place[3] = {static_cast<float>(at[0]), static_cast<float>(at[1]), static_cast<float>(at[2])};
            const auto whole = [&](std::size_t a) { return origin[a] + static_cast<std::size_t>(at[a]); };
            place[axis] += static_cast<float>(edge_crossing(samples_, signs_, isovalue_, axis, whole(0), whole(1), whole(2)));
            clouds.add(place[0], place[1], place[2]);
        });
    }

  private:
    static constexpr std::size_t kLevels = 3 * 5 + 3;  // the block, at most five halvings per axis, one box on trial
    const GridView<Sample>& samples_;
    const SignGrid& signs_;
    double isovalue_;
};

// One extraction, step by step; climb() below is their order.
template <class Sample, class Coordinate>
class Climb {
  public:
    Climb(const GridView<Sample>& samples, const Options& options)
        : samples_(samples),
          options_(options),
          signs_(classify(samples, options.isovalue, options.below, options.capped, options.threads)),
          bars_(lay_out_bars(signs_, options.block_size)),
          layout_(signs_) {}

    void partition() {
        const Gatherer<Sample> gatherer(samples_, signs_, options_);
        const bool bounded = std::isfinite(options_.max_error);
        for_bars([&](std::size_t n, Bar& bar) {
            static_cast<BarBoxes&>(bar) = partition_bar(signs_, options_.block_size, n % bars_.blocks[1], n / bars_.blocks[1],
                                                        bounded ? &gatherer : nullptr);
        });
        mark_all(bars_, options_.threads, layout_);
    }

    void number_and_place_vertices() {
        const std::size_t rows = signs_.dims[1], planes = signs_.dims[2];
        parallel_for(options_.threads, planes, [&](std::size_t k) {
            for (std::size_t j = 0; j < rows; ++j) layout_.count_row(j, k);
        });
        mesh_.vertices.resize(3 * layout_.number());
        parallel_for(options_.threads, planes, [&](std::size_t k) {
            for (std::size_t j = 0; j < rows; ++j) {
                Coordinate* out = mesh_.vertices.data() + 3 * std::size_t{layout_.base(j, k)[0]};
                write_row_vertices(samples_, signs_, options_.isovalue, j, k, out,
                                   [&](int axis, std::size_t w) { return layout_.kept(axis, w, j, k); });
            }
        });
    }

    // Draws the bars that are stale, which are all of them at first.
    void draw() {
        bound_triangles(signs_, layout_, bars_);
        mesh_.triangles.resize(3 * bars_.triangles_at_most);
        draw_stale();
    }

    // Halves the boxes that break the bound. False if there are none.
    bool split() {
        const std::vector<LateBox> late = split_broken(signs_, bars_);
        if (late.empty()) return false;
        std::vector<GridEdge> inserted;
        for (const LateBox& part : late) layout_.insert(part.origin, part.box, inserted);
        number_and_place_vertices();
        std::vector<std::size_t> numbers;
        for (const GridEdge& edge : inserted) numbers.push_back(layout_.number(edge));
        const Renumbering renumbered(std::move(numbers));

        std::vector<std::size_t> before;
        for (const Bar& bar : bars_.bars) before.push_back(bar.first_triangle);
        bound_triangles(signs_, layout_, bars_);
        mesh_.triangles.resize(3 * bars_.triangles_at_most);
        move_triangles(before, bars_, mesh_.triangles);
        for_bars([&](std::size_t, Bar& bar) {
            if (bar.stale) return;
            std::int32_t* const first = mesh_.triangles.data() + 3 * bar.first_triangle;
            std::transform(first, first + 3 * bar.triangles, first, renumbered);
        });
        draw_stale();
        return true;
    }

    Mesh<Coordinate> take() {
        close_gaps(bars_, mesh_.triangles);
        mesh_.facts = sum_facts(bars_);
        for (std::size_t k = 0; k < signs_.dims[2]; ++k) {
            for (std::size_t j = 0; j < signs_.dims[1]; ++j) mesh_.facts.crossings += count_crossings(signs_, j, k);
        }
        return std::move(mesh_);
    }

  private:
    template <class Work>
    void for_bars(const Work& work) {
        parallel_for(options_.threads, bars_.bars.size(), [&](std::size_t n) { work(n, bars_.bars[n]); });
    }

    void draw_stale() {
        for_bars([&](std::size_t n, Bar& bar) {
            if (!bar.stale) return;
            Drawer<Sample, Coordinate> drawer(samples_, signs_, layout_, options_, mesh_.vertices.data());
            std::int32_t* const first = mesh_.triangles.data() + 3 * bar.first_triangle;
            bar.triangles = static_cast<std::size_t>(drawer.draw(bars_, n, bar, first) - first) / 3;
        });
    }

    GridView<Sample> samples_;
    const Options& options_;
    SignGrid signs_;
    Bars bars_;
    Layout layout_;
    Mesh<Coordinate> mesh_;
};

}  // namespace

template <class Sample, class Coordinate>
Mesh<Coordinate> climb(GridView<Sample> samples, const Options& options) {
    if (*std::min_element(samples.dims.begin(), samples.dims.end()) < 2) {
        throw std::invalid_argument("climbing needs two samples per axis");
    }
    Climb<Sample, Coordinate> work(samples, options);
    work.partition();
    work.number_and_place_vertices();
    work.draw();
    while (work.split()) {
    }
    return work.take();
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
