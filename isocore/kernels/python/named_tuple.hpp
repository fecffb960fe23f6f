// named_tuple.hpp - Results by name: a function that returns several things returns a named tuple, whose type is an
// attribute of the module and is declared as a NamedTuple in isocore/_kernels.pyi.
#pragma once

#include <nanobind/nanobind.h>

#include <initializer_list>
#include <utility>

namespace isocore::python {

class NamedTuple {
  public:
    // Makes the type and adds it to the module.
    NamedTuple(nanobind::module_& module, const char* name, std::initializer_list<const char*> fields) {
        nanobind::list names;
        for (const char* field : fields) names.append(field);
        type_ = nanobind::module_::import_("collections")
                    .attr("namedtuple")(name, names, nanobind::arg("module") = module.attr("__name__"));
        module.attr(name) = type_;
    }

    // A new tuple with one value per field, in the order of the fields; Python refuses any other number of values.
    // The GIL must be held.
    template <class... Values>
    nanobind::object operator()(Values&&... values) const {
        return type_(std::forward<Values>(values)...);
    }

  private:
    nanobind::object type_;
};

}  // namespace isocore::python
