// bind_simplification.cpp - simplify(vertices, triangles, reference_vertices, reference_triangles, max_error, stretch,
// other, cell, most_triangles, writing, threads), once per type of coordinates.
#include <nanobind/stl/array.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/affine.hpp"
#include "python/arrays.hpp"
#include "python/bindings.hpp"
#include "python/named_tuple.hpp"
#include "simplification/simplify.hpp"

namespace isocore::python {
namespace {

using Triangles = Rows<std::int32_t, 3>;

template <class Real>
simplification::MeshArrays<Real> arrays(const Rows<Real, 3>& vertices, const Triangles& triangles) {
    return {vertices.data(), vertices.shape(0), triangles.data(), triangles.shape(0)};
}

template <class Real>
void bind(nb::module_& module, const NamedTuple& simplified) {
    module.def(
        "simplify",
        [=](const Rows<Real, 3>& vertices, const Triangles& triangles, const Rows<Real, 3>& reference_vertices,
            const Triangles& reference_triangles, double max_error, const std::array<double, 3>& stretch,
            const std::array<double, 3>& other, double cell, std::size_t most_triangles, const Writing* writing,
            int threads) {
            const simplification::Options options{
                max_error, stretch, cell, other, most_triangles, writing == nullptr ? Writing{} : *writing, threads};
            const simplification::MeshArrays<Real> input = arrays(vertices, triangles);
            simplification::Simplified<Real> out;
            {
                const nb::gil_scoped_release unlocked;
                out = simplification::simplify(input, arrays(reference_vertices, reference_triangles), options);
            }
            const auto& f = out.facts;
            const double count = std::max<double>(1, static_cast<double>(reference_vertices.shape(0)));
            const auto deviation = [&](const simplification::Deviation& found) {
                return nb::make_tuple(found.max, found.sum / count, std::sqrt(found.squares / count));
            };
            return simplified(to_numpy(std::move(out.vertices), 3), to_numpy(std::move(out.triangles), 3),
                              to_numpy(std::move(out.kept)), f.collapses,
                              nb::make_tuple(f.refused[0], f.refused[1], f.refused[2], f.refused[3], f.refused[4]),
                              f.unproved, deviation(f.error), deviation(f.other), f.back_max);
        },
        nb::arg("vertices").noconvert(), nb::arg("triangles").noconvert(), nb::arg("reference_vertices").noconvert(),
        nb::arg("reference_triangles").noconvert(), nb::arg("max_error"),
        nb::arg("stretch") = std::array<double, 3>{1, 1, 1}, nb::arg("other") = std::array<double, 3>{1, 1, 1},
        nb::arg("cell") = 1.0, nb::arg("most_triangles") = 0, nb::arg("writing").none() = nb::none(),
        nb::arg("threads") = 1);
}

}  // namespace

void bind_simplification(nb::module_& module) {
    const NamedTuple simplified(
        module, "SimplifiedMesh",
        {"vertices", "triangles", "kept", "collapses", "refused", "unproved", "error", "error_other", "back_max"});
    nb::class_<Writing>(module, "Writing")
        .def(
            "__init__",
            [](Writing* made, const AffineArray& affine, bool is_single, double rounding) {
                new (made) Writing{to_affine(affine), is_single, rounding};
            },
            nb::arg("affine").noconvert(), nb::arg("is_single"), nb::arg("rounding"));
    bind<float>(module, simplified);
    bind<double>(module, simplified);
}

}  // namespace isocore::python
