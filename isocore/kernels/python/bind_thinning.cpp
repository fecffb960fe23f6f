// bind_thinning.cpp - build_index(points, tets, hexes, values) and propagate(points, values, index arrays..., isovalue,
// threads, single).
#include "thinning/mesh/thinning.hpp"

#include <cstdint>
#include <utility>

#include "python/arrays.hpp"
#include "python/bindings.hpp"

namespace isocore::python {
namespace {

template <class T>
using Scratch = nb::ndarray<T, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
template <std::size_t columns>
using Records = Rows<std::int32_t, static_cast<std::ptrdiff_t>(columns)>;

constexpr std::size_t kTetRecord = thinning::kRecord<mesh::Tet>, kHexRecord = thinning::kRecord<mesh::Hex>;

nb::tuple part_to_numpy(thinning::Part&& part, std::size_t columns) {
    nb::list classes;
    for (const std::size_t count : part.classes) classes.append(count);
    const thinning::Oddities& odd = part.oddities;
    return nb::make_tuple(to_numpy(std::move(part.records), columns), to_numpy(std::move(part.skeleton)),
                          to_numpy(std::move(part.low)), to_numpy(std::move(part.high)), part.extrema,
                          nb::tuple(classes), odd.crowded_faces,
                          nb::make_tuple(odd.crowded_cells[0], odd.crowded_cells[1], odd.crowded_cells[2]),
                          odd.collapsed_cells, odd.collapsed_cell);
}

template <class Value>
nb::object build(const Rows<double, 3>& points, const Rows<std::int32_t, 4>& tets, const Rows<std::int32_t, 8>& hexes,
                 const Vector<Value>& values) {
    const mesh::Field<Value> field{points.data(), values.data(), values.shape(0)};
    thinning::Index index;
    {
        const nb::gil_scoped_release unlocked;
        index = thinning::build(field, {tets.data(), hexes.data(), tets.shape(0), hexes.shape(0)});
    }
    return nb::make_tuple(part_to_numpy(std::move(index.tets), kTetRecord),
                          part_to_numpy(std::move(index.hexes), kHexRecord), to_numpy(std::move(index.points)),
                          index.edge_count);
}

template <std::size_t columns>
thinning::PartView view(const Records<columns>& records, const Vector<std::int32_t>& skeleton,
                        const Vector<double>& low, const Vector<double>& high) {
    return {records.data(), skeleton.data(), low.data(), high.data(), records.shape(0), skeleton.shape(0)};
}

// The arrays of an index, in the order in which Python hands them over.
#define ISOCORE_INDEX_PARAMETERS                                                                                \
    const Rows<double, 3>&points, const Vector<Value>&values, const Records<kTetRecord>&tets,                   \
        const Vector<std::int32_t>&tet_skeleton, const Vector<double>&tet_low, const Vector<double>&tet_high,   \
        const Records<kHexRecord>&hexes, const Vector<std::int32_t>&hex_skeleton, const Vector<double>&hex_low, \
        const Vector<double>&hex_high, const Vector<std::int32_t>&original, const Scratch<std::int32_t>&vertex_of_edge
#define ISOCORE_INDEX_VIEW                                                                                   \
    const mesh::Field<Value> field{points.data(), values.data(), values.shape(0)};                           \
    const thinning::IndexView index {                                                                        \
        view<kTetRecord>(tets, tet_skeleton, tet_low, tet_high),                                             \
            view<kHexRecord>(hexes, hex_skeleton, hex_low, hex_high), original.data(), vertex_of_edge.data() \
    }

template <class Coordinate, class Value>
nb::object propagate_to(const mesh::Field<Value>& field, const thinning::IndexView& index, double isovalue,
                        int threads) {
    thinning::Mesh<Coordinate> mesh;
    {
        const nb::gil_scoped_release unlocked;
        mesh = thinning::propagate<Coordinate>(field, index, isovalue, threads);
    }
    return nb::make_tuple(to_numpy(std::move(mesh.vertices), 3), to_numpy(std::move(mesh.triangles), 3), mesh.seeds,
                          mesh.visited);
}

template <class Value>
nb::object propagate(ISOCORE_INDEX_PARAMETERS, double isovalue, int threads, bool single) {
    ISOCORE_INDEX_VIEW;
    return single ? propagate_to<float>(field, index, isovalue, threads)
                  : propagate_to<double>(field, index, isovalue, threads);
}

template <class Value>
nb::object walk(ISOCORE_INDEX_PARAMETERS, double isovalue) {
    ISOCORE_INDEX_VIEW;
    thinning::Visited visited;
    {
        const nb::gil_scoped_release unlocked;
        visited = thinning::walk(field, index, isovalue);
    }
    return nb::make_tuple(to_numpy(std::move(visited.tets)), to_numpy(std::move(visited.hexes)), visited.seeds);
}

template <class Value, class Function, class... Extra>
void bind_search(nb::module_& module, const char* name, Function function, Extra... extra) {
    module.def(name, function, nb::arg("points").noconvert(), nb::arg("values").noconvert(),
               nb::arg("tets").noconvert(), nb::arg("tet_skeleton").noconvert(), nb::arg("tet_low").noconvert(),
               nb::arg("tet_high").noconvert(), nb::arg("hexes").noconvert(), nb::arg("hex_skeleton").noconvert(),
               nb::arg("hex_low").noconvert(), nb::arg("hex_high").noconvert(), nb::arg("original").noconvert(),
               nb::arg("vertex_of_edge").noconvert(), nb::arg("isovalue"), extra...);
}

template <class Value>
void bind(nb::module_& module) {
    module.def("build_index", &build<Value>, nb::arg("points").noconvert(), nb::arg("tets").noconvert(),
               nb::arg("hexes").noconvert(), nb::arg("values").noconvert());
    bind_search<Value>(module, "propagate", &propagate<Value>, nb::arg("threads") = 1, nb::arg("single") = false);
    bind_search<Value>(module, "walk", &walk<Value>);
}

}  // namespace

void bind_thinning(nb::module_& module) {
    bind<float>(module);
    bind<double>(module);
}

}  // namespace isocore::python
