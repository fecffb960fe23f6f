#include "python/arrays.hpp"
#include "python/bindings.hpp"
namespace isocore::python {
void bind_marching_cubes(nb::module_&) {}
}
