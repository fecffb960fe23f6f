// bind_grid_thinning.cpp - thin_grid(samples, below, capped) and propagate_grid(samples, skeleton arrays..., isovalue,
// ...), once per sample type.
#include "thinning/grid/grid_thinning.hpp"

#include <cstdint>
#include <utility>

#include "python/arrays.hpp"
#include "python/bindings.hpp"
#include "samples/sample_types.hpp"

namespace isocore::python {
namespace {

template <class Sample>
nb::object thin(const VolumeArray<Sample>& samples, bool below, bool capped) {
    thinning::GridSkeleton skeleton;
    {
        const nb::gil_scoped_release unlocked;
        skeleton = thinning::thin_grid(grid_view(samples), {below, capped});
    }
    return nb::make_tuple(to_numpy(std::move(skeleton.cells)), to_numpy(std::move(skeleton.low)),
                          to_numpy(std::move(skeleton.high)), skeleton.extrema);
}

template <class Sample>
nb::object propagate(const VolumeArray<Sample>& samples, const Vector<std::int32_t>& skeleton,
                     const Vector<double>& low, const Vector<double>& high,
                     const nb::ndarray<std::int32_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>& place,
                     double isovalue, bool below, bool capped, int threads) {
    const thinning::GridSkeletonView view{skeleton.data(), low.data(), high.data(), skeleton.shape(0), place.data()};
    thinning::GridMesh mesh;
    {
        const nb::gil_scoped_release unlocked;
        mesh = thinning::propagate_grid(grid_view(samples), view, isovalue, {below, capped}, threads);
    }
    return nb::make_tuple(to_numpy(std::move(mesh.vertices), 3), to_numpy(std::move(mesh.triangles), 3), mesh.seeds,
                          mesh.visited, mesh.ambiguous_faces, mesh.ambiguous_cells);
}

template <class Sample>
void bind(nb::module_& module) {
    module.def("thin_grid", &thin<Sample>, nb::arg("samples").noconvert(), nb::arg("below") = false,
               nb::arg("capped") = false);
    module.def("propagate_grid", &propagate<Sample>, nb::arg("samples").noconvert(), nb::arg("skeleton").noconvert(),
               nb::arg("low").noconvert(), nb::arg("high").noconvert(), nb::arg("place").noconvert(),
               nb::arg("isovalue"), nb::arg("below") = false, nb::arg("capped") = false, nb::arg("threads") = 1);
}

}  // namespace

void bind_grid_thinning(nb::module_& module) {
    for_each_sample_type([&]<class Sample>() { bind<Sample>(module); });
}

}  // namespace isocore::python
