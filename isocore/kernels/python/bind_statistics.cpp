// bind_statistics.cpp - Extents, ranks and histograms for numpy: samples as a flat view, in whatever order they lie in
// memory.
#include "statistics/selection.hpp"
#include "statistics/statistics.hpp"

#include "python/arrays.hpp"
#include "python/bindings.hpp"
#include "python/named_tuple.hpp"
#include "samples/sample_types.hpp"

namespace isocore::python {
namespace {

template <class Sample>
void bind_type(nb::module_& module, const NamedTuple& sample_extent, const NamedTuple& within,
               const NamedTuple& ranked) {
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
        "extent_between",
        [=](const Vector<Sample>& samples, double low, double high, int threads) {
            Within found{};
            {
                const nb::gil_scoped_release release;
                found = extent_between(samples.data(), samples.shape(0), low, high, threads);
            }
            return within(found.minimum, found.maximum, found.count);
        },
        nb::arg("samples").noconvert(), nb::arg("low"), nb::arg("high"), nb::arg("threads"));
    module.def(
        "sample_of_rank",
        [=](const Vector<Sample>& samples, double low, double high, std::uint64_t rank, int threads) {
            Ranked found{};
            {
                const nb::gil_scoped_release release;
                found = sample_of_rank(samples.data(), samples.shape(0), low, high, rank, threads);
            }
            return ranked(found.value, found.below, found.equal);
        },
        nb::arg("samples").noconvert(), nb::arg("low"), nb::arg("high"), nb::arg("rank"), nb::arg("threads"));
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
    const NamedTuple within(module, "Within", {"minimum", "maximum", "samples"});
    const NamedTuple ranked(module, "Ranked", {"value", "below", "equal"});
    for_each_sample_type([&]<class Sample>() { bind_type<Sample>(module, sample_extent, within, ranked); });
}

}  // namespace isocore::python
