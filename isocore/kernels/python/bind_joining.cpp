// bind_joining.cpp - join_points(points, distance): which points of a mesh coincide.
#include "joining/join_points.hpp"
#include "python/arrays.hpp"
#include "python/bindings.hpp"
#include "python/named_tuple.hpp"

namespace isocore::python {

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
}

}  // namespace isocore::python
