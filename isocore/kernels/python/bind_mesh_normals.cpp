// bind_mesh_normals.cpp - mesh_normals(points, tets, hexes, values, isovalue, edges, vertices, triangles, threads,
// complete), for float32 and float64 values and vertices.
#include "surface/mesh_normals.hpp"

#include "python/arrays.hpp"
#include "python/bindings.hpp"

namespace isocore::python {
namespace {

template <class Value, class Real>
void bind(nb::module_& module) {
    module.def(
        "mesh_normals",
        [](const Rows<double, 3>& points, const Rows<std::int32_t, 4>& tets, const Rows<std::int32_t, 8>& hexes,
           const Vector<Value>& values, double isovalue, const Rows<std::int32_t, 2>& edges,
           const Rows<Real, 3>& vertices, const Rows<std::int32_t, 3>& triangles, int threads, bool complete) {
            if (values.shape(0) != points.shape(0)) throw std::invalid_argument("there must be one value per point");
            const mesh::Field<Value> field{points.data(), values.data(), values.shape(0)};
            const CellsView cells{tets.data(), hexes.data(), tets.shape(0), hexes.shape(0)};
            const MeshView<Real> surface{vertices.data(), vertices.shape(0), triangles.data(), triangles.shape(0)};
            Array<float> normals;
            {
                const nb::gil_scoped_release unlocked;
                normals =
                    mesh_normals(field, cells, isovalue, {edges.data(), edges.shape(0)}, surface, complete, threads);
            }
            return to_numpy(std::move(normals), 3);
        },
        nb::arg("points").noconvert(), nb::arg("tets").noconvert(), nb::arg("hexes").noconvert(),
        nb::arg("values").noconvert(), nb::arg("isovalue"), nb::arg("edges").noconvert(),
        nb::arg("vertices").noconvert(), nb::arg("triangles").noconvert(), nb::arg("threads") = 1,
        nb::arg("complete") = true);
}

}  // namespace

void bind_mesh_normals(nb::module_& module) {
    bind<float, float>(module);
    bind<float, double>(module);
    bind<double, float>(module);
    bind<double, double>(module);
}

}  // namespace isocore::python
