// bind_statistics.cpp - extent and histogram for numpy: samples as a flat view, in whatever order they lie in memory.
#include "statistics/statistics.hpp"

#include "python/arrays.hpp"
#include "python/bindings.hpp"
#include "python/named_tuple.hpp"
#include "samples/sample_types.hpp"

namespace isocore::python {
namespace {

template <class Sample>
void bind_type(nb::module_& module, const NamedTuple& sample_extent) {
    module.def(
        "extent",
        [=](const Vector<Sample>& samples, int threads) {
            Extent found{};
            {
                const nb::gil_scoped_release release;
                found = extent(samples.data(), samples.shape(0), threads);
            }
            return sample_extent(found.minimum, found.maximum, found.nonfinite);
        },
        nb::arg("samples").noconvert(), nb::arg("threads"));
    module.def(
        "histogram",
        [](const Vector<Sample>& samples, double low, double high, std::size_t bins, int threads) {
            Array<std::uint64_t> counts;
            {
                const nb::gil_scoped_release release;
                counts = histogram(samples.data(), samples.shape(0), low, high, bins, threads);
            }
            return to_numpy(std::move(counts));
        },
        nb::arg("samples").noconvert(), nb::arg("low"), nb::arg("high"), nb::arg("bins"), nb::arg("threads"));
}

}  // namespace

void bind_statistics(nb::module_& module) {
    const NamedTuple sample_extent(module, "Extent", {"minimum", "maximum", "nonfinite"});
    for_each_sample_type([&]<class Sample>() { bind_type<Sample>(module, sample_extent); });
}

}  // namespace isocore::python
