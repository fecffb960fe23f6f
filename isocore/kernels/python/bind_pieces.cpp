// bind_pieces.cpp - Python's view of kernels/surface/pieces: the shells of a mesh, and which of them make up a piece.
#include "python/arrays.hpp"
#include "python/bindings.hpp"
#include "python/named_tuple.hpp"
#include "surface/pieces/nesting.hpp"
#include "surface/pieces/shells.hpp"

namespace isocore::python {
namespace {

template <class T, class Member>
nb::object column(const Shells& found, Member member) {
    Array<T> values;
    values.reserve(found.shells.size());
    for (const Shell& shell : found.shells) values.push_back(static_cast<T>(shell.*member));
    return to_numpy(std::move(values));
}

template <class Real>
void bind_real(nb::module_& module, const NamedTuple& shells) {
    module.def(
        "shells",
        [=](const Rows<Real, 3>& vertices, const Rows<std::int32_t, 3>& triangles, int threads) {
            const MeshView<Real> mesh{vertices.data(), vertices.shape(0), triangles.data(), triangles.shape(0)};
            Shells found;
            Nesting nesting;
            {
                nb::gil_scoped_release unlocked;
                found = shells_of(mesh, threads);
                nesting = nesting_of(mesh, found, threads);
            }
            return shells(to_numpy(std::move(found.of_vertex)), column<std::int64_t>(found, &Shell::triangles),
                          column<double>(found, &Shell::area), column<double>(found, &Shell::volume),
                          column<std::uint8_t>(found, &Shell::closed), to_numpy(std::move(nesting.around)),
                          to_numpy(std::move(nesting.piece)));
        },
        nb::arg("vertices").noconvert(), nb::arg("triangles").noconvert(), nb::arg("threads") = 1);
}

}  // namespace

void bind_pieces(nb::module_& module) {
    const NamedTuple shells(module, "Shells",
                            {"of_vertex", "triangles", "areas", "volumes", "closed", "around", "piece"});
    bind_real<float>(module, shells);
    bind_real<double>(module, shells);
}

}  // namespace isocore::python
