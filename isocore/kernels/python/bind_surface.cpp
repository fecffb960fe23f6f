// bind_surface.cpp - Python's view of kernels/surface: measuring, placing, normals, and the bytes of mesh files.
#include <nanobind/stl/string.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "python/arrays.hpp"
#include "python/bindings.hpp"
#include "python/named_tuple.hpp"
#include "samples/sample_types.hpp"
#include "surface/format.hpp"
#include "surface/intersections/self_intersections.hpp"
#include "surface/measure.hpp"
#include "surface/nearness/distances.hpp"
#include "surface/normals.hpp"
#include "surface/place.hpp"
#include "surface/size.hpp"
#include "surface/tilt.hpp"
#include "surface/unit.hpp"
#include "surface/weld.hpp"

namespace isocore::python {
namespace {

using Triangles = Rows<std::int32_t, 3>;
template <class T>
using OwnRows = nb::ndarray<T, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;

template <class Real>
MeshView<Real> mesh_view(const Rows<Real, 3>& vertices, const Triangles& triangles) {
    return {vertices.data(), vertices.shape(0), triangles.data(), triangles.shape(0)};
}

nb::tuple as_tuple(const std::array<double, 6>& b) { return nb::make_tuple(b[0], b[1], b[2], b[3], b[4], b[5]); }

template <class Real>
void bind_measure(nb::module_& module, const NamedTuple& measured) {
    module.def(
        "measure",
        [=](const Rows<Real, 3>& vertices, const Triangles& triangles, int threads) {
            Measured m;
            {
                nb::gil_scoped_release unlocked;
                m = measure(mesh_view(vertices, triangles), threads);
            }
            return measured(m.components, m.boundary_edges, m.nonmanifold_edges, m.nonmanifold_vertices,
                            m.misoriented_edges, m.euler, m.degenerate, m.area, m.volume, as_tuple(m.bounds));
        },
        nb::arg("vertices").noconvert(), nb::arg("triangles").noconvert(), nb::arg("threads") = 1);
}

template <class From, class To>
void place_vertices(const Rows<From, 3>& vertices, const AffineArray& affine, const OwnRows<To>& out, int threads) {
    if (vertices.shape(0) != out.shape(0)) throw std::invalid_argument("out must be as long as vertices");
    nb::gil_scoped_release unlocked;
    place(vertices.data(), vertices.shape(0), to_affine(affine), out.data(), threads);
}

template <class Sample, class Real>
nb::object normals_of_samples(const VolumeArray<Sample>& samples, const Rows<Real, 3>& vertices,
                              const Triangles& triangles, bool below, int threads, bool complete) {
    if (samples.shape(0) < 2 || samples.shape(1) < 2 || samples.shape(2) < 2) {
        throw std::invalid_argument("samples need two per axis");
    }
    Array<float> normals;
    {
        nb::gil_scoped_release unlocked;
        const GridView<const Sample> view{samples.data(), {samples.shape(0), samples.shape(1), samples.shape(2)}};
        normals = gradient_normals(view, mesh_view(vertices, triangles), below, complete, threads);
    }
    return to_numpy(std::move(normals), 3);
}

template <class Real>
nb::object normals_of_triangles(const Rows<Real, 3>& vertices, const Triangles& triangles) {
    Array<float> normals;
    {
        nb::gil_scoped_release unlocked;
        normals = triangle_normals(mesh_view(vertices, triangles));
    }
    return to_numpy(std::move(normals), 3);
}

template <class Make>
nb::bytes make_text(const Make& make) {
    std::string text;
    {
        nb::gil_scoped_release unlocked;
        text = make();
    }
    return nb::bytes(text.data(), text.size());
}

template <class Make>
nb::object make_records(const Make& make, std::size_t columns = 0) {
    decltype(make()) records;
    {
        nb::gil_scoped_release unlocked;
        records = make();
    }
    return to_numpy(std::move(records), columns);
}

template <class Real>
nb::bytes text_of_rows(const std::string& tag, const Rows<Real, 3>& rows, int threads) {
    if (tag.size() > 4) throw std::invalid_argument("a tag has at most four letters");
    return make_text([&] { return format_rows(tag.c_str(), rows.data(), rows.shape(0), threads); });
}

template <class Real>
void bind_real(nb::module_& module) {
    using nb::arg;
    module.def(
        "bounds", [](const Rows<Real, 3>& vertices) { return as_tuple(bounds(vertices.data(), vertices.shape(0))); },
        arg("vertices").noconvert());
    module.def("place", &place_vertices<Real, float>, arg("vertices").noconvert(), arg("affine").noconvert(),
               arg("out").noconvert(), arg("threads") = 1);
    module.def("place", &place_vertices<Real, double>, arg("vertices").noconvert(), arg("affine").noconvert(),
               arg("out").noconvert(), arg("threads") = 1);
    module.def("triangle_normals", &normals_of_triangles<Real>, arg("vertices").noconvert(),
               arg("triangles").noconvert());
    module.def("format_rows", &text_of_rows<Real>, arg("tag"), arg("rows").noconvert(), arg("threads") = 1);
    module.def(
        "stl_records",
        [](const Rows<Real, 3>& vertices, const Triangles& triangles, int threads) {
            return make_records([&] { return stl_records(mesh_view(vertices, triangles), threads); });
        },
        arg("vertices").noconvert(), arg("triangles").noconvert(), arg("threads") = 1);
    module.def(
        "self_intersections",
        [](const Rows<Real, 3>& vertices, const Triangles& triangles, int threads) {
            nb::gil_scoped_release unlocked;
            return self_intersections(mesh_view(vertices, triangles), threads);
        },
        arg("vertices").noconvert(), arg("triangles").noconvert(), arg("threads") = 1);
    module.def(
        "complete_normals",
        [](const Rows<Real, 3>& vertices, const Triangles& triangles, const OwnRows<float>& normals) {
            if (normals.shape(0) != vertices.shape(0)) throw std::invalid_argument("there must be a normal per vertex");
            const nb::gil_scoped_release unlocked;
            complete_normals(mesh_view(vertices, triangles), normals.data());
        },
        arg("vertices").noconvert(), arg("triangles").noconvert(), arg("normals").noconvert());
    module.def(
        "tilt",
        [](const Rows<Real, 3>& vertices, const Triangles& triangles, const Rows<float, 3>& normals,
           const AffineArray& affine, int threads) {
            if (normals.shape(0) != vertices.shape(0)) throw std::invalid_argument("there must be a normal per vertex");
            Tilt found;
            {
                const nb::gil_scoped_release unlocked;
                found = tilt(mesh_view(vertices, triangles), normals.data(), to_affine(affine), threads);
            }
            return nb::make_tuple(found.mean, found.p95, found.max, found.count);
        },
        arg("vertices").noconvert(), arg("triangles").noconvert(), arg("normals").noconvert(),
        arg("affine").noconvert(), arg("threads") = 1);
    module.def(
        "weld",
        [](const Rows<Real, 3>& vertices, int threads) {
            return make_records([&] { return weld(vertices.data(), vertices.shape(0), threads); });
        },
        arg("vertices").noconvert(), arg("threads") = 1);
}

template <class Sample>
void bind_sample(nb::module_& module) {
    using nb::arg;
    module.def("gradient_normals", &normals_of_samples<Sample, float>, arg("samples").noconvert(),
               arg("vertices").noconvert(), arg("triangles").noconvert(), arg("below"), arg("threads") = 1,
               arg("complete") = true);
    module.def("gradient_normals", &normals_of_samples<Sample, double>, arg("samples").noconvert(),
               arg("vertices").noconvert(), arg("triangles").noconvert(), arg("below"), arg("threads") = 1,
               arg("complete") = true);
}

}  // namespace

void bind_surface(nb::module_& module) {
    using nb::arg;
    const NamedTuple measured(module, "Measured",
                              {"components", "boundary_edges", "nonmanifold_edges", "nonmanifold_vertices",
                               "misoriented_edges", "euler", "degenerate", "area", "volume", "bounds"});
    bind_measure<float>(module, measured);
    bind_measure<double>(module, measured);
    bind_real<float>(module);
    bind_real<double>(module);
    for_each_sample_type([&]<class Sample>() { bind_sample<Sample>(module); });
    module.def(
        "flip",
        [](const OwnRows<std::int32_t>& triangles, int threads) {
            nb::gil_scoped_release unlocked;
            flip(triangles.data(), triangles.shape(0), threads);
        },
        arg("triangles").noconvert(), arg("threads") = 1);
    module.def(
        "turn_normals",
        [](const OwnRows<float>& normals, const AffineArray& affine, int threads) {
            nb::gil_scoped_release unlocked;
            turn_normals(normals.data(), normals.shape(0), to_affine(affine), threads);
        },
        arg("normals").noconvert(), arg("affine").noconvert(), arg("threads") = 1);
    module.def(
        "distances_to",
        [=](const Rows<double, 3>& vertices, const Triangles& triangles, const Rows<double, 3>& points, int threads) {
            const std::size_t count = points.shape(0);
            Distances found;
            {
                nb::gil_scoped_release unlocked;
                found = distances_to(mesh_view(vertices, triangles), points.data(), count, threads);
            }
            const double all = count ? static_cast<double>(count) : 1;
            return nb::make_tuple(found.largest, found.sum / all, std::sqrt(found.squares / all));
        },
        arg("vertices").noconvert(), arg("triangles").noconvert(), arg("points").noconvert(), arg("threads") = 1);
    module.def(
        "nine_digits",
        [](const Rows<double, 3>& rows, int threads) {
            return make_records([&] { return nine_digits(rows.data(), 3 * rows.shape(0), threads); }, 3);
        },
        arg("rows").noconvert(), arg("threads") = 1);
    module.def(
        "format_faces",
        [](const Triangles& triangles, bool with_normals, int threads) {
            return make_text([&] { return format_faces(triangles.data(), triangles.shape(0), with_normals, threads); });
        },
        arg("triangles").noconvert(), arg("with_normals"), arg("threads") = 1);
    module.def(
        "ply_faces",
        [](const Triangles& triangles, int threads) {
            return make_records([&] { return ply_faces(triangles.data(), triangles.shape(0), threads); });
        },
        arg("triangles").noconvert(), arg("threads") = 1);
}

}  // namespace isocore::python
