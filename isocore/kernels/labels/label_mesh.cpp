// label_mesh.cpp - Slabs of a volume, extracted each for itself and joined in order.
#include "labels/label_mesh.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "common/large_pages.hpp"
#include "common/parallel.hpp"
#include "labels/slab.hpp"
#include "samples/sample_types.hpp"

namespace isocore::labels {
namespace {

// How many layers of cells a slab has. The plane below each is surveyed a second time, so that slabs are thick; but
// every thread has two of them. One thread takes a few layers as one slab, which then need not be moved.
std::size_t layers_of_slab(std::size_t layers, int threads) {
    constexpr std::size_t kLeast = 4, kMost = 16;
    if (threads <= 1) return layers <= 2 * kMost ? layers : kMost;
    const std::size_t slabs = 2 * static_cast<std::size_t>(threads);
    return std::clamp((layers + slabs - 1) / slabs, kLeast, kMost);
}

// Writes a plane of ranks with background around it; planes before the first and after the last are background.
template <class Sample, class Rank>
void load_plane(const GridView<Sample>& samples, const RankTable& ranks, std::size_t plane, Rank* out) {
    const std::size_t row = samples.dims[0] + 2, rows = samples.dims[1] + 2;
    if (plane == 0 || plane > samples.dims[2]) {
        std::fill_n(out, row * rows, Rank{0});
        return;
    }
    std::fill_n(out, row, Rank{0});
    std::fill_n(out + row * (rows - 1), row, Rank{0});
    for (std::size_t j = 0; j < samples.dims[1]; ++j) {
        Rank* line = out + row * (j + 1);
        line[0] = line[row - 1] = 0;
        ranks.look_up(samples.row(j, plane - 1), samples.dims[0], line + 1);
    }
}

// How many vertices the layers `first` to `last` - 1 will have, at most in most maps: one for each two neighbours that
// differ, of which those of every fourth row are counted, and some in the middles of faces and cells. An array that is
// too small is copied as it grows, to pages that are new each time; what of it is too large is never touched.
template <class Sample>
std::size_t expect_vertices(const GridView<Sample>& samples, std::size_t first, std::size_t last) {
    constexpr std::size_t kStride = 4;
    const auto [columns, rows, planes] = samples.dims;
    std::size_t sum = 0;
    const auto compare = [&](const Sample* one, const Sample* other, std::size_t count) {
        for (std::size_t n = 0; n < count; ++n) sum += one[n] != other[n];
    };
    for (std::size_t k = std::max<std::size_t>(first, 1) - 1; k < std::min(last, planes); ++k) {
        for (std::size_t j = k % kStride; j < rows; j += kStride) {
            const Sample* const row = samples.row(j, k);
            compare(row, row + 1, columns - 1);
            if (j + 1 < rows) compare(row, samples.row(j + 1, k), columns);
            if (k + 1 < planes) compare(row, samples.row(j, k + 1), columns);
        }
    }
    return kStride * sum * 11 / 8;
}

struct Sizes {
    std::size_t vertices = 0, triangles = 0, curves = 0;
};

// Moves a slab's mesh to its place in the whole, and frees it. A negative number names a vertex of the plane below,
// whose vertices end where the middles of the layer below begin.
void place_slab(SlabMesh& slab, const Sizes& at, std::size_t middles_below, LabelMesh& out) {
    const auto base = static_cast<std::int32_t>(at.vertices), below = base - static_cast<std::int32_t>(middles_below);
    const auto renumber = [&](std::int32_t number) { return number + (number < 0 ? below : base); };
    std::copy(slab.vertices.begin(), slab.vertices.end(), out.vertices.data() + 3 * at.vertices);
    std::copy(slab.elements.begin(), slab.elements.end(), out.elements.data() + at.vertices);
    std::copy(slab.sides.begin(), slab.sides.end(), out.sides.data() + 2 * at.triangles);
    std::transform(slab.triangles.begin(), slab.triangles.end(), out.triangles.data() + 3 * at.triangles, renumber);
    std::transform(slab.curves.begin(), slab.curves.end(), out.curves.data() + at.curves, renumber);
    slab = {};
}

// Extracts the slabs one by one.
template <class Rank, class Sample>
std::vector<SlabMesh> draw_slabs(const GridView<Sample>& samples, const RankTable& ranks, int threads) {
    const Dims dims{samples.dims[0] + 2, samples.dims[1] + 2, samples.dims[2] + 2};
    const std::size_t layers = dims[2] - 1, thick = layers_of_slab(layers, threads);
    std::vector<SlabMesh> slabs((layers + thick - 1) / thick);
    parallel_for(
        threads, slabs.size(), [&] { return Slab<Rank>(dims); },
        [&](Slab<Rank>& slab, std::size_t n) {
            const auto load = [&](std::size_t plane, Rank* out) { load_plane(samples, ranks, plane, out); };
            const std::size_t first = n * thick, last = std::min(layers, first + thick);
            slabs[n] = slab.draw(first, last, expect_vertices(samples, first, last), load);
        });
    return slabs;
}

}  // namespace

template <class Sample>
LabelMesh extract(GridView<Sample> samples, const RankTable& ranks, int threads) {
    const auto holds = [&]<class Rank>(Rank) { return ranks.highest() <= std::numeric_limits<Rank>::max(); };
    std::vector<SlabMesh> slabs = holds(std::uint8_t{})    ? draw_slabs<std::uint8_t>(samples, ranks, threads)
                                  : holds(std::uint16_t{}) ? draw_slabs<std::uint16_t>(samples, ranks, threads)
                                                           : draw_slabs<std::uint32_t>(samples, ranks, threads);
    const std::size_t count = slabs.size();
    std::vector<Sizes> starts(count + 1);
    for (std::size_t n = 0; n < count; ++n) {
        starts[n + 1] = {starts[n].vertices + slabs[n].elements.size(), starts[n].triangles + slabs[n].sides.size() / 2,
                         starts[n].curves + slabs[n].curves.size()};
    }
    constexpr auto kMost = static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max());
    if (starts[count].vertices > kMost || starts[count].triangles > kMost) {
        throw std::length_error("the labels' surfaces have more than 2^31 vertices or triangles");
    }
    if (count == 1) return std::move(slabs[0]);
    std::vector<std::size_t> middles(count + 1);
    for (std::size_t n = 0; n < count; ++n) middles[n + 1] = slabs[n].last_middles;
    LabelMesh mesh{large_array<float>(3 * starts[count].vertices), large_array<Element>(starts[count].vertices),
                   large_array<std::int32_t>(3 * starts[count].triangles),
                   large_array<std::uint32_t>(2 * starts[count].triangles),
                   large_array<std::int32_t>(starts[count].curves)};
    parallel_for(threads, count, [&](std::size_t n) { place_slab(slabs[n], starts[n], middles[n], mesh); });
    return mesh;
}

#define ISOCORE_EXTRACT(Sample) template LabelMesh extract(GridView<Sample>, const RankTable&, int);
ISOCORE_FOR_EACH_SAMPLE_TYPE(ISOCORE_EXTRACT)
#undef ISOCORE_EXTRACT

}  // namespace isocore::labels
