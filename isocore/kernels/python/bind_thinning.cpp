// bind_thinning.cpp - build_index(points, tets, hexes, values); in_order(points, values, original); and the class
// Index: an index and its mesh, checked once and then ready to propagate one isovalue after the other.
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/variant.h>

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <tuple>
#include <utility>
#include <variant>

#include "python/arrays.hpp"
#include "python/bindings.hpp"
#include "python/named_tuple.hpp"
#include "thinning/mesh/ordering.hpp"
#include "thinning/mesh/thinning.hpp"

namespace isocore::python {
namespace {

constexpr std::size_t kTetRecord = thinning::kRecord<mesh::Tet>, kHexRecord = thinning::kRecord<mesh::Hex>;

nb::object part_to_numpy(thinning::Part&& part, std::size_t columns, const NamedTuple& index_part) {
    nb::list classes;
    for (const std::size_t count : part.classes) classes.append(count);
    const thinning::Oddities& odd = part.oddities;
    return index_part(to_numpy(std::move(part.records), columns), to_numpy(std::move(part.skeleton)),
                      to_numpy(std::move(part.low)), to_numpy(std::move(part.high)), part.extrema, nb::tuple(classes),
                      odd.crowded_faces,
                      nb::make_tuple(odd.crowded_cells[0], odd.crowded_cells[1], odd.crowded_cells[2]),
                      odd.collapsed_cells, odd.collapsed_cell);
}

template <class Value>
void bind_build(nb::module_& module, const NamedTuple& index_part, const NamedTuple& built_index) {
    module.def(
        "build_index",
        [=](const Rows<double, 3>& points, const Rows<std::int32_t, 4>& tets, const Rows<std::int32_t, 8>& hexes,
            const Vector<Value>& values, int threads, std::size_t cells_per_block) {
            const mesh::Field<Value> field{points.data(), values.data(), values.shape(0)};
            thinning::Index index;
            {
                const nb::gil_scoped_release unlocked;
                index = thinning::build(field, {tets.data(), hexes.data(), tets.shape(0), hexes.shape(0)},
                                        {threads, cells_per_block});
            }
            return built_index(part_to_numpy(std::move(index.tets), kTetRecord, index_part),
                               part_to_numpy(std::move(index.hexes), kHexRecord, index_part),
                               to_numpy(std::move(index.points)));
        },
        nb::arg("points").noconvert(), nb::arg("tets").noconvert(), nb::arg("hexes").noconvert(),
        nb::arg("values").noconvert(), nb::arg("threads") = 1, nb::arg("cells_per_block") = 0);
}

template <class Value>
void bind_order(nb::module_& module, const NamedTuple& ordered_field) {
    module.def(
        "in_order",
        [=](const Rows<double, 3>& points, const Vector<Value>& values, const Vector<std::int32_t>& original,
            int threads) {
            if (values.shape(0) != points.shape(0)) throw std::invalid_argument("there must be one value per point");
            const mesh::Field<Value> field{points.data(), values.data(), values.shape(0)};
            thinning::OrderedField<Value> ordered;
            {
                const nb::gil_scoped_release unlocked;
                ordered = thinning::in_order(field, original.data(), original.shape(0), threads);
            }
            return ordered_field(to_numpy(std::move(ordered.points), 3), to_numpy(std::move(ordered.values)));
        },
        nb::arg("points").noconvert(), nb::arg("values").noconvert(), nb::arg("original").noconvert(),
        nb::arg("threads") = 1);
}

// Records, skeleton, low and high ends of all cells of one kind.
template <std::size_t columns>
using PartArrays = std::tuple<Rows<std::int32_t, static_cast<std::ptrdiff_t>(columns)>, Vector<std::int32_t>,
                              Vector<double>, Vector<double>>;

template <std::size_t columns>
thinning::PartView view(const PartArrays<columns>& part) {
    const auto& [records, skeleton, low, high] = part;
    if (low.shape(0) != skeleton.shape(0) || high.shape(0) != skeleton.shape(0)) {
        throw std::invalid_argument("low and high must be as long as the skeleton");
    }
    return {records.data(), skeleton.data(), low.data(), high.data(), records.shape(0), skeleton.shape(0)};
}

// Keeps the arrays it was made from alive, and copies none of them.
class Index {
  public:
    using Values = std::variant<Vector<float>, Vector<double>>;

    Index(Rows<double, 3> points, Values values, PartArrays<kTetRecord> tets, PartArrays<kHexRecord> hexes,
          Vector<std::int32_t> original, bool built)
        : points_(std::move(points)),
          values_(std::move(values)),
          tets_(std::move(tets)),
          hexes_(std::move(hexes)),
          original_(std::move(original)),
          view_{view<kTetRecord>(tets_), view<kHexRecord>(hexes_), original_.data()} {
        const std::size_t count = points_.shape(0);
        if (original_.shape(0) != count || std::visit([](const auto& v) { return v.shape(0); }, values_) != count) {
            throw std::invalid_argument("there must be one value and one original id per point");
        }
        if (built) return;
        const nb::gil_scoped_release unlocked;
        thinning::check_index(view_, count);
    }

  private:
    // Calls work(field, scratch) for the mesh with its values, without the GIL.
    template <class Work>
    auto with_scratch(const Work& work) const {
        const nb::gil_scoped_release unlocked;
        return std::visit(
            [&]<class Value>(const Vector<Value>& values) {
                const mesh::Field<std::remove_const_t<Value>> field{points_.data(), values.data(), values.shape(0)};
                return scratches_.lend([&](thinning::Scratch& scratch) { return work(field, scratch); });
            },
            values_);
    }

  public:
    nb::object propagate(double isovalue, int threads, bool single, bool with_edges,
                         const NamedTuple& walked_mesh) const {
        return single ? propagate_to<float>(isovalue, threads, with_edges, walked_mesh)
                      : propagate_to<double>(isovalue, threads, with_edges, walked_mesh);
    }

    nb::object walk(double isovalue, const NamedTuple& visited_cells) const {
        thinning::Visited visited = with_scratch(
            [&](const auto& field, auto& scratch) { return thinning::walk(field, view_, isovalue, scratch); });
        return visited_cells(to_numpy(std::move(visited.tets)), to_numpy(std::move(visited.hexes)), visited.seeds);
    }

  private:
    template <class Coordinate>
    nb::object propagate_to(double isovalue, int threads, bool with_edges, const NamedTuple& walked_mesh) const {
        thinning::Mesh<Coordinate> mesh = with_scratch([&](const auto& field, auto& scratch) {
            return thinning::propagate<Coordinate>(field, view_, isovalue, threads, with_edges, scratch);
        });
        return walked_mesh(to_numpy(std::move(mesh.vertices), 3), to_numpy(std::move(mesh.triangles), 3), mesh.seeds,
                           mesh.visited, to_numpy(std::move(mesh.edges), 2));
    }

    Rows<double, 3> points_;
    Values values_;
    PartArrays<kTetRecord> tets_;
    PartArrays<kHexRecord> hexes_;
    Vector<std::int32_t> original_;
    thinning::IndexView view_;
    mutable thinning::ScratchPool scratches_;
};

}  // namespace

void bind_thinning(nb::module_& module) {
    using nb::arg;
    const NamedTuple index_part(module, "IndexPart",
                                {"records", "skeleton", "low", "high", "extrema", "classes", "crowded_faces",
                                 "crowded_cells", "collapsed_cells", "collapsed_cell"});
    const NamedTuple built_index(module, "BuiltIndex", {"tets", "hexes", "original"});
    bind_build<float>(module, index_part, built_index);
    bind_build<double>(module, index_part, built_index);
    const NamedTuple ordered_field(module, "OrderedField", {"points", "values"});
    bind_order<float>(module, ordered_field);
    bind_order<double>(module, ordered_field);

    const NamedTuple walked_mesh(module, "WalkedMesh", {"vertices", "triangles", "seeds", "visited", "edges"});
    const NamedTuple visited_cells(module, "VisitedCells", {"tets", "hexes", "seeds"});
    nb::class_<Index>(module, "Index")
        .def(nb::init<Rows<double, 3>, Index::Values, PartArrays<kTetRecord>, PartArrays<kHexRecord>,
                      Vector<std::int32_t>, bool>(),
             arg("points").noconvert(), arg("values").noconvert(), arg("tets").noconvert(), arg("hexes").noconvert(),
             arg("original").noconvert(), arg("built") = false)
        .def(
            "propagate",
            [=](const Index& index, double isovalue, int threads, bool single, bool with_edges) {
                return index.propagate(isovalue, threads, single, with_edges, walked_mesh);
            },
            arg("isovalue"), arg("threads") = 1, arg("single") = false, arg("with_edges") = false)
        .def(
            "walk", [=](const Index& index, double isovalue) { return index.walk(isovalue, visited_cells); },
            arg("isovalue"));
}

}  // namespace isocore::python
