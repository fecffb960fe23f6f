// bind_climbing.cpp - climb(samples, isovalue, below, capped, threads, block_size, max_error, in_world, spacing,
// measured, ranges, tilted) and sample_ranges(samples, threads), once per sample type.
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>

#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "climbing/climb.hpp"
#include "python/arrays.hpp"
#include "python/bindings.hpp"
#include "python/named_tuple.hpp"
#include "samples/sample_ranges.hpp"
#include "samples/sample_types.hpp"
#include "surface/normals.hpp"

namespace isocore::python {
namespace {

// The named tuples that a climb returns.
struct Results {
    NamedTuple climbed, facts, deviation;

    explicit Results(nb::module_& module)
        : climbed(module, "ClimbedVolume", {"vertices", "triangles", "facts"}),
          facts(module, "ClimbingFacts",
                {"highrices", "blocks", "blocks_visited", "ambiguous_faces", "ambiguous_cells", "split_again",
                 "error_voxels", "error_world"}),
          deviation(module, "Deviation", {"max", "mean", "rms"}) {}

    nb::object of(const climbing::Deviation& found, std::size_t crossings) const {
        const double count = crossings ? static_cast<double>(crossings) : 1;
        return deviation(found.max, found.sum / count, std::sqrt(found.squares / count));
    }
    nb::object of(const climbing::Facts& found) const {
        return facts(found.highrices, found.blocks, found.blocks_visited, found.ambiguous_faces, found.ambiguous_cells,
                     found.split_again, of(found.in_voxels, found.crossings), of(found.in_world, found.crossings));
    }
};

template <class Sample, class Coordinate>
nb::object run(const VolumeArray<Sample>& samples, const climbing::Options& options, const Sample* ranges, bool tilted,
               const Results& results) {
    climbing::Mesh<Coordinate> mesh;
    {
        const nb::gil_scoped_release unlocked;
        const auto view = grid_view(samples);
        climbing::Slopes<Coordinate> slopes;
        if (tilted) {
            slopes = [&](const Array<Coordinate>& vertices) {
                const MeshView<Coordinate> places{vertices.data(), vertices.size() / 3, nullptr, 0};
                const GridView<const Sample> own{view.data, view.dims};
                return gradient_normals(own, places, options.below, false, options.threads);
            };
        }
        mesh = climbing::climb<Sample, Coordinate>(view, options, ranges, slopes);
    }
    return results.climbed(to_numpy(std::move(mesh.vertices), 3), to_numpy(std::move(mesh.triangles), 3),
                           results.of(mesh.facts));
}

template <class Sample>
void bind(nb::module_& module, const Results& results) {
    module.def(
        "climb",
        [=](const VolumeArray<Sample>& samples, double isovalue, bool below, bool capped, int threads, int block_size,
            double max_error, bool in_world, const std::array<double, 3>& spacing, bool measured,
            const std::optional<Vector<Sample>>& ranges, bool tilted) {
            const climbing::Options options{isovalue,  below,    capped,  threads, block_size,
                                            max_error, in_world, spacing, measured};
            if (ranges && ranges->size() != range_count(grid_view(samples).dims))
                throw nb::value_error("ranges of another volume");
            const Sample* given = ranges ? ranges->data() : nullptr;
            return floats_suffice(grid_view(samples).dims)
                       ? run<Sample, float>(samples, options, given, tilted, results)
                       : run<Sample, double>(samples, options, given, tilted, results);
        },
        nb::arg("samples").noconvert(), nb::arg("isovalue"), nb::arg("below") = false, nb::arg("capped") = false,
        nb::arg("threads") = 1, nb::arg("block_size") = 16,
        nb::arg("max_error") = std::numeric_limits<double>::infinity(), nb::arg("in_world") = false,
        nb::arg("spacing") = std::array<double, 3>{1, 1, 1}, nb::arg("measured") = true,
        nb::arg("ranges").noconvert() = nb::none(), nb::arg("tilted") = false);
    module.def(
        "sample_ranges",
        [](const VolumeArray<Sample>& samples, int threads) {
            Array<Sample> ranges;
            {
                const nb::gil_scoped_release unlocked;
                ranges = sample_ranges(grid_view(samples), threads);
            }
            return to_numpy(std::move(ranges));
        },
        nb::arg("samples").noconvert(), nb::arg("threads") = 1);
}

}  // namespace

void bind_climbing(nb::module_& module) {
    const Results results(module);
    for_each_sample_type([&]<class Sample>() { bind<Sample>(module, results); });
}

}  // namespace isocore::python
