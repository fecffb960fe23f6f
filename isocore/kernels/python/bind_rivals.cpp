// bind_rivals.cpp - extrema_graph(records, corners, faces, at_extremum) over the records of a thinning index.
#include "rivals/extrema_graph.hpp"

#include <stdexcept>
#include <utility>

#include "python/arrays.hpp"
#include "python/bindings.hpp"

namespace isocore::python {
namespace {

nb::object extrema_graph(const Rows<std::int32_t, -1>& records, std::size_t corners, std::size_t faces,
                         const Vector<std::uint8_t>& at_extremum) {
    if (corners + faces > records.shape(1) || at_extremum.shape(0) != records.shape(0)) {
        throw std::invalid_argument("records do not have that many columns, or there is not one flag per record");
    }
    Array<std::int32_t> kept;
    {
        const nb::gil_scoped_release unlocked;
        kept = rivals::extrema_graph(records.data() + corners, records.shape(1), records.shape(0), faces,
                                     at_extremum.data());
    }
    return to_numpy(std::move(kept));
}

}  // namespace

void bind_rivals(nb::module_& module) {
    module.def("extrema_graph", &extrema_graph, nb::arg("records").noconvert(), nb::arg("corners"), nb::arg("faces"),
               nb::arg("at_extremum").noconvert());
}

}  // namespace isocore::python
