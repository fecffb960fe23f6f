// bind_ambiguities.cpp - ambiguities(samples, isovalue, below, threads), once per sample type.
#include "ambiguities/ambiguities.hpp"

#include "python/arrays.hpp"
#include "python/bindings.hpp"
#include "python/named_tuple.hpp"
#include "samples/sample_types.hpp"

namespace isocore::python {
namespace {

template <class Sample>
void bind(nb::module_& module, const NamedTuple& ambiguous_faces) {
    module.def(
        "ambiguities",
        [=](const VolumeArray<Sample>& samples, double isovalue, bool below, int threads) {
            ambiguities::Found found;
            {
                const nb::gil_scoped_release unlocked;
                found = ambiguities::find(grid_view(samples), isovalue, below, threads);
            }
            return ambiguous_faces(to_numpy(std::move(found.places), 3), to_numpy(std::move(found.distances)));
        },
        nb::arg("samples").noconvert(), nb::arg("isovalue"), nb::arg("below") = false, nb::arg("threads") = 1);
}

}  // namespace

void bind_ambiguities(nb::module_& module) {
    const NamedTuple ambiguous_faces(module, "AmbiguousFaces", {"places", "distances"});
    for_each_sample_type([&]<class Sample>() { bind<Sample>(module, ambiguous_faces); });
}

}  // namespace isocore::python
