// bind_clusters.cpp - cluster(vertices, triangles, most), once per type of coordinates.
#include <utility>

#include "python/arrays.hpp"
#include "python/bindings.hpp"
#include "surface/clusters.hpp"

namespace isocore::python {
namespace {

template <class Real>
void bind(nb::module_& module) {
    module.def(
        "cluster",
        [](const Rows<Real, 3>& vertices, const Rows<std::int32_t, 3>& triangles, std::size_t most) {
            Clusters found;
            {
                const nb::gil_scoped_release unlocked;
                const MeshView<Real> mesh{vertices.data(), vertices.shape(0), triangles.data(), triangles.shape(0)};
                found = cluster(mesh, most);
            }
            return nb::make_tuple(to_numpy(std::move(found.kept)), to_numpy(std::move(found.triangles), 3));
        },
        nb::arg("vertices").noconvert(), nb::arg("triangles").noconvert(), nb::arg("most"));
}

}  // namespace

void bind_clusters(nb::module_& module) {
    bind<float>(module);
    bind<double>(module);
}

}  // namespace isocore::python
