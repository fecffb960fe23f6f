// bind_marching_cells.cpp - marching_cells(points, tets, hexes, values, isovalue, threads, single,
// with_edges), for float32 and
// float64 values.
#include "marching_cells/marching_cells.hpp"

#include "python/arrays.hpp"
#include "python/bindings.hpp"
#include "python/named_tuple.hpp"

namespace isocore::python {
namespace {

template <class Coordinate, class Value>
nb::object march_to(const mesh::Field<Value>& field, const marching_cells::Cells& cells, double isovalue, int threads,
                    bool with_edges, const NamedTuple& marched_mesh) {
    marching_cells::Mesh<Coordinate> mesh;
    {
        const nb::gil_scoped_release unlocked;
        mesh = marching_cells::march<Coordinate>(field, cells, isovalue, threads, with_edges);
    }
    return marched_mesh(to_numpy(std::move(mesh.vertices), 3), to_numpy(std::move(mesh.triangles), 3), mesh.intersected,
                        to_numpy(std::move(mesh.edges), 2));
}

template <class Value>
void bind(nb::module_& module, const NamedTuple& marched_mesh) {
    module.def(
        "marching_cells",
        [=](const Rows<double, 3>& points, const Rows<std::int32_t, 4>& tets, const Rows<std::int32_t, 8>& hexes,
            const Vector<Value>& values, double isovalue, int threads, bool single, bool with_edges) {
            const mesh::Field<Value> field{points.data(), values.data(), values.shape(0)};
            const marching_cells::Cells cells{tets.data(), hexes.data(), tets.shape(0), hexes.shape(0)};
            return single ? march_to<float>(field, cells, isovalue, threads, with_edges, marched_mesh)
                          : march_to<double>(field, cells, isovalue, threads, with_edges, marched_mesh);
        },
        nb::arg("points").noconvert(), nb::arg("tets").noconvert(), nb::arg("hexes").noconvert(),
        nb::arg("values").noconvert(), nb::arg("isovalue"), nb::arg("threads") = 1, nb::arg("single") = false,
        nb::arg("with_edges") = false);
}

}  // namespace

void bind_marching_cells(nb::module_& module) {
    const NamedTuple marched_mesh(module, "MarchedMesh", {"vertices", "triangles", "intersected", "edges"});
    bind<float>(module, marched_mesh);
    bind<double>(module, marched_mesh);
}

}  // namespace isocore::python
