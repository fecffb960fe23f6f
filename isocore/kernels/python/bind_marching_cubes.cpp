// bind_marching_cubes.cpp - marching_cubes(samples, isovalue, below, capped, threads, trilinear), once per sample type.
#include "marching_cubes/marching_cubes.hpp"

#include "python/arrays.hpp"
#include "python/bindings.hpp"
#include "python/named_tuple.hpp"
#include "samples/sample_types.hpp"

namespace isocore::python {
namespace {

template <class Sample, class Coordinate>
nb::object run(const VolumeArray<Sample>& samples, const marching_cubes::Options& options,
               const NamedTuple& marched_volume) {
    marching_cubes::Mesh<Coordinate> mesh;
    {
        const nb::gil_scoped_release unlocked;
        mesh = marching_cubes::march<Sample, Coordinate>(grid_view(samples), options);
    }
    return marched_volume(to_numpy(std::move(mesh.vertices), 3), to_numpy(std::move(mesh.triangles), 3),
                          mesh.ambiguous_faces, mesh.ambiguous_cells, mesh.tubes);
}

template <class Sample>
void bind(nb::module_& module, const NamedTuple& marched_volume) {
    module.def(
        "marching_cubes",
        [=](const VolumeArray<Sample>& samples, double isovalue, bool below, bool capped, int threads, bool trilinear) {
            const marching_cubes::Options options{isovalue, below, capped, trilinear, threads};
            return floats_suffice(grid_view(samples).dims) ? run<Sample, float>(samples, options, marched_volume)
                                                           : run<Sample, double>(samples, options, marched_volume);
        },
        nb::arg("samples").noconvert(), nb::arg("isovalue"), nb::arg("below") = false, nb::arg("capped") = false,
        nb::arg("threads") = 1, nb::arg("trilinear") = false);
}

}  // namespace

void bind_marching_cubes(nb::module_& module) {
    const NamedTuple marched_volume(module, "MarchedVolume",
                                    {"vertices", "triangles", "ambiguous_faces", "ambiguous_cells", "tubes"});
    for_each_sample_type([&]<class Sample>() { bind<Sample>(module, marched_volume); });
}

}  // namespace isocore::python
