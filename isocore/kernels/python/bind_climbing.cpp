// bind_climbing.cpp - climb(samples, isovalue, below, capped, threads, block_size, max_error, in_world, spacing,
// measured, ranges) and sample_ranges(samples, threads), once per sample type.
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>

#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "climbing/climb.hpp"
#include "python/arrays.hpp"
#include "python/bindings.hpp"
#include "samples/sample_ranges.hpp"
#include "samples/sample_types.hpp"

namespace isocore::python {
namespace {

nb::tuple error_tuple(const climbing::Deviation& deviation, std::size_t crossings) {
    const double count = crossings ? static_cast<double>(crossings) : 1;
    return nb::make_tuple(deviation.max, deviation.sum / count, std::sqrt(deviation.squares / count));
}

nb::dict facts_dict(const climbing::Facts& facts) {
    nb::dict out;
    out["highrices"] = facts.highrices;
    out["blocks"] = facts.blocks;
    out["blocks_visited"] = facts.blocks_visited;
    out["ambiguous_faces"] = facts.ambiguous_faces;
    out["ambiguous_cells"] = facts.ambiguous_cells;
    out["split_again"] = facts.split_again;
    out["error_voxels"] = error_tuple(facts.in_voxels, facts.crossings);
    out["error_world"] = error_tuple(facts.in_world, facts.crossings);
    return out;
}

template <class Sample, class Coordinate>
nb::object run(const VolumeArray<Sample>& samples, const climbing::Options& options, const Sample* ranges) {
    climbing::Mesh<Coordinate> mesh;
    {
        const nb::gil_scoped_release unlocked;
        mesh = climbing::climb<Sample, Coordinate>(grid_view(samples), options, ranges);
    }
    return nb::make_tuple(to_numpy(std::move(mesh.vertices), 3), to_numpy(std::move(mesh.triangles), 3),
                          facts_dict(mesh.facts));
}

template <class Sample>
void bind(nb::module_& module) {
    module.def(
        "climb",
        [](VolumeArray<Sample> samples, double isovalue, bool below, bool capped, int threads, int block_size,
           double max_error, bool in_world, std::array<double, 3> spacing, bool measured,
           std::optional<Vector<Sample>> ranges) {
            const climbing::Options options{isovalue,  below,    capped,  threads, block_size,
                                            max_error, in_world, spacing, measured};
            if (ranges && ranges->size() != range_count(grid_view(samples).dims))
                throw nb::value_error("ranges of another volume");
            const Sample* given = ranges ? ranges->data() : nullptr;
            return floats_suffice(grid_view(samples).dims) ? run<Sample, float>(samples, options, given)
                                                      : run<Sample, double>(samples, options, given);
        },
        nb::arg("samples").noconvert(), nb::arg("isovalue"), nb::arg("below") = false, nb::arg("capped") = false,
        nb::arg("threads") = 1, nb::arg("block_size") = 16,
        nb::arg("max_error") = std::numeric_limits<double>::infinity(), nb::arg("in_world") = false,
        nb::arg("spacing") = std::array<double, 3>{1, 1, 1}, nb::arg("measured") = true,
        nb::arg("ranges").noconvert() = nb::none());
    module.def(
        "sample_ranges",
        [](VolumeArray<Sample> samples, int threads) {
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
    for_each_sample_type([&]<class Sample>() { bind<Sample>(module); });
}

}  // namespace isocore::python
