// bind_labels.cpp - Python's view of kernels/labels: which labels a volume holds, and the mesh that they share.
#include <nanobind/stl/array.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>

#include "common/affine.hpp"
#include "common/large_pages.hpp"
#include "labels/census.hpp"
#include "labels/label_mesh.hpp"
#include "labels/sheets.hpp"
#include "labels/smooth.hpp"
#include "labels/solids.hpp"
#include "python/arrays.hpp"
#include "python/bindings.hpp"
#include "python/named_tuple.hpp"
#include "samples/sample_types.hpp"
#include "simplification/simplify.hpp"
#include "surface/mesh_view.hpp"

namespace isocore::python {
namespace {

template <class From>
nb::object copied(const From& values) {
    using T = typename From::value_type;
    return to_numpy(Array<T>(values.begin(), values.end()));
}

using simplification::Facts;
using simplification::SheetFacts;

Array<std::uint64_t> refused_of(const Facts& facts) {
    Array<std::uint64_t> out;
    for (const SheetFacts& sheet : facts.sheets) out.insert(out.end(), sheet.refused.begin(), sheet.refused.end());
    return out;
}

Array<std::uint64_t> unproved_of(const Facts& facts) {
    Array<std::uint64_t> out;
    for (const SheetFacts& sheet : facts.sheets) out.push_back(sheet.unproved);
    return out;
}

Array<double> back_of(const Facts& facts) {
    Array<double> out;
    for (const SheetFacts& sheet : facts.sheets) out.push_back(sheet.back_max);
    return out;
}

Array<double> errors_of(const Facts& facts, simplification::Deviation SheetFacts::* which) {
    Array<double> out;
    for (const SheetFacts& sheet : facts.sheets) {
        const simplification::Deviation& error = sheet.*which;
        for (const double number : {error.max, error.sum, error.squares}) out.push_back(number);
    }
    return out;
}

// The mesh and its lists of triangles by label. Python asks for one label at a time, from any thread.
class LabelSurfaces {
  public:
    LabelSurfaces(labels::LabelMesh mesh, std::size_t ranks) : mesh_(std::move(mesh)), ranks_(ranks) {}

    std::size_t vertices() const { return mesh_.elements.size(); }
    std::size_t triangles() const { return mesh_.triangles.size() / 3; }

    void smooth(int rounds, int threads) {
        const nb::gil_scoped_release unlocked;
        const std::lock_guard<std::mutex> alone(one_at_a_time_);
        labels::smooth(mesh_, rounds, threads);
    }

    nb::object solid(std::size_t rank, const NamedTuple& label_solid) {
        labels::Solid solid;
        {
            const nb::gil_scoped_release unlocked;
            const std::lock_guard<std::mutex> alone(one_at_a_time_);
            if (!solids_) solids_.emplace(mesh_, ranks_);
            solid = solids_->solid(mesh_, rank);
        }
        return label_solid(to_numpy(std::move(solid.vertices), 3), to_numpy(std::move(solid.triangles), 3),
                           to_numpy(std::move(solid.shared)));
    }

    nb::object simplify(const simplification::Options& options, const NamedTuple& simplified_labels) {
        labels::Sheets sheets;
        simplification::Facts facts;
        std::size_t before = 0;
        {
            const nb::gil_scoped_release unlocked;
            const std::lock_guard<std::mutex> alone(one_at_a_time_);
            before = triangles();
            sheets = labels::take_sheets(mesh_);
            return_freed_memory();
            const simplification::MeshArrays<float> arrays{mesh_.vertices.data(),  vertices(),
                                                           mesh_.triangles.data(), before,
                                                           &sheets.of_triangles,   sheets.pairs.size() / 2};
            simplification::Simplified<float> fewer = simplification::simplify(arrays, arrays, options);
            facts = std::move(fewer.facts);
            labels::replace(mesh_, sheets, std::move(fewer.vertices), std::move(fewer.triangles), fewer.kept,
                            fewer.left);
            solids_.reset();
        }
        return simplified_labels(to_numpy(std::move(sheets.pairs), 2), to_numpy(std::move(sheets.vertices)),
                                 to_numpy(std::move(sheets.triangles)), before, triangles(), facts.collapses,
                                 to_numpy(refused_of(facts), simplification::kRules), to_numpy(unproved_of(facts)),
                                 to_numpy(errors_of(facts, &simplification::SheetFacts::error), 3),
                                 to_numpy(errors_of(facts, &simplification::SheetFacts::other), 3),
                                 to_numpy(back_of(facts)));
    }

    nb::object neighbours() const { return to_numpy(labels::neighbours(mesh_), 2); }

    // All that is shared, copied: for tests, and for whoever wants the whole mesh.
    nb::object shared(const NamedTuple& label_mesh) const {
        auto copy = mesh_;
        return label_mesh(to_numpy(std::move(copy.vertices), 3), to_numpy(std::move(copy.elements)),
                          to_numpy(std::move(copy.triangles), 3), to_numpy(std::move(copy.sides), 2));
    }

  private:
    labels::LabelMesh mesh_;
    std::size_t ranks_;
    std::optional<labels::Solids> solids_;  // made when the first label is asked for
    std::mutex one_at_a_time_;
};

template <class Real>
void bind_smooth(nb::module_& module) {
    using nb::arg;
    module.def(
        "smooth_isosurface",
        [](const nb::ndarray<Real, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>& vertices,
           const Rows<std::int32_t, 3>& triangles, int rounds, int threads) {
            const nb::gil_scoped_release unlocked;
            check_indices(triangles.data(), triangles.shape(0), vertices.shape(0));
            labels::smooth(vertices.data(), vertices.shape(0), triangles.data(), triangles.shape(0), rounds, threads);
        },
        arg("vertices").noconvert(), arg("triangles").noconvert(), arg("rounds"), arg("threads") = 1);
}

template <class Sample>
void bind_sample(nb::module_& module, const NamedTuple& label_census) {
    using nb::arg;
    module.def(
        "label_census",
        [=](const Vector<Sample>& samples, std::size_t most) {
            labels::Census census;
            {
                const nb::gil_scoped_release unlocked;
                census = labels::take_census(samples.data(), samples.shape(0), most);
            }
            return label_census(copied(census.values), copied(census.counts), census.not_a_number, census.too_many,
                                census.not_whole);
        },
        arg("samples").noconvert(), arg("most"));
    module.def(
        "label_surfaces",
        [](const VolumeArray<Sample>& samples, const Vector<double>& values, const Vector<std::uint32_t>& ranks,
           int threads) {
            if (values.shape(0) != ranks.shape(0)) throw std::invalid_argument("values and ranks differ in number");
            const nb::gil_scoped_release unlocked;
            const std::span all(ranks.data(), ranks.shape(0));
            const std::uint32_t highest = all.empty() ? 0 : *std::max_element(all.begin(), all.end());
            const labels::RankTable table({values.data(), values.shape(0)}, all);
            return new LabelSurfaces(labels::extract(grid_view(samples), table, threads), std::size_t{highest} + 1);
        },
        arg("samples").noconvert(), arg("values").noconvert(), arg("ranks").noconvert(), arg("threads") = 1,
        nb::rv_policy::take_ownership);
}

}  // namespace

void bind_labels(nb::module_& module) {
    using nb::arg;
    const NamedTuple label_census(module, "LabelCensus", {"values", "counts", "not_a_number", "too_many", "not_whole"});
    const NamedTuple label_solid(module, "LabelSolid", {"vertices", "triangles", "shared"});
    const NamedTuple simplified_labels(module, "SimplifiedLabels",
                                       {"pairs", "vertices_before", "triangles_before", "all_before", "all_after",
                                        "collapses", "refused", "unproved", "error", "error_other", "back_max"});
    const NamedTuple label_mesh(module, "LabelMesh", {"vertices", "elements", "triangles", "sides"});
    nb::class_<LabelSurfaces>(module, "LabelSurfaces")
        .def_prop_ro("vertices", &LabelSurfaces::vertices)
        .def_prop_ro("triangles", &LabelSurfaces::triangles)
        .def("neighbours", &LabelSurfaces::neighbours)
        .def("smooth", &LabelSurfaces::smooth, arg("rounds"), arg("threads") = 1)
        .def("trim", [](const LabelSurfaces&) { return_freed_memory(); })
        .def(
            "simplify",
            [=](LabelSurfaces& all, double max_error, const std::array<double, 3>& stretch,
                const std::array<double, 3>& other, std::size_t most_triangles, const Writing* writing, int threads) {
                return all.simplify({max_error, stretch, 1.0, other, most_triangles,
                                     writing == nullptr ? Writing{} : *writing, threads},
                                    simplified_labels);
            },
            arg("max_error"), arg("stretch") = std::array<double, 3>{1, 1, 1},
            arg("other") = std::array<double, 3>{1, 1, 1}, arg("most_triangles") = 0,
            arg("writing").none() = nb::none(), arg("threads") = 1)
        .def(
            "solid", [=](LabelSurfaces& all, std::size_t rank) { return all.solid(rank, label_solid); }, arg("rank"))
        .def("shared", [=](const LabelSurfaces& all) { return all.shared(label_mesh); });
    bind_smooth<float>(module);
    bind_smooth<double>(module);
    for_each_sample_type([&]<class Sample>() { bind_sample<Sample>(module, label_census); });
}

}  // namespace isocore::python
