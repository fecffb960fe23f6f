// bind_joining.cpp - join_points(points, distance): which points of a mesh coincide; renumbered(corners, number) and
// values_agree(values, number, joined): what becomes of cells and values then.
#include <stdexcept>

#include "joining/join_points.hpp"
#include "joining/renumber.hpp"
#include "python/arrays.hpp"
#include "python/bindings.hpp"
#include "python/named_tuple.hpp"

namespace isocore::python {
namespace {

template <class Value>
void bind_values_agree(nb::module_& module) {
    module.def(
        "values_agree",
        [](const Vector<Value>& values, const Vector<std::int32_t>& number, const Vector<Value>& joined) {
            if (values.shape(0) != number.shape(0)) throw std::invalid_argument("a value and a number for each point");
            const nb::gil_scoped_release unlocked;
            return values_agree(values.data(), values.shape(0), number.data(), joined.data(), joined.shape(0));
        },
        nb::arg("values").noconvert(), nb::arg("number").noconvert(), nb::arg("joined").noconvert());
}

}  // namespace

void bind_joining(nb::module_& module) {
    const NamedTuple joined_points(module, "JoinedPoints", {"number", "first"});
    module.def(
        "join_points",
        [=](const Rows<double, 3>& points, double distance) {
            JoinedPoints found;
            {
                const nb::gil_scoped_release unlocked;
                found = join_points(points.data(), points.shape(0), distance);
            }
            return joined_points(to_numpy(std::move(found.number)), to_numpy(std::move(found.first)));
        },
        nb::arg("points").noconvert(), nb::arg("distance") = 0.0);
    module.def(
        "renumbered",
        [](const Vector<std::int32_t>& corners, const Vector<std::int32_t>& number) {
            Array<std::int32_t> result;
            {
                const nb::gil_scoped_release unlocked;
                result = renumbered(corners.data(), corners.shape(0), number.data(), number.shape(0));
            }
            return to_numpy(std::move(result));
        },
        nb::arg("corners").noconvert(), nb::arg("number").noconvert());
    bind_values_agree<float>(module);
    bind_values_agree<double>(module);
}

}  // namespace isocore::python
