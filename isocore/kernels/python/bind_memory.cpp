// bind_memory.cpp - How this process takes memory.
#include "common/large_pages.hpp"

#include "python/bindings.hpp"

namespace isocore::python {

void bind_memory(nanobind::module_& module) { module.def("share_one_heap", &share_one_heap); }

}  // namespace isocore::python
