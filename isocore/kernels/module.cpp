// module.cpp - The map of the compiled module: one line per algorithm. What each offers is typed in
// isocore/_kernels.pyi; how arrays cross the border stands in python/arrays.hpp.
#include "python/bindings.hpp"

NB_MODULE(ISOCORE_MODULE, module) {
    nanobind::set_leak_warnings(false);  // an index that lives until the interpreter ends is no news for stderr
    isocore::python::bind_climbing(module);
    isocore::python::bind_ambiguities(module);
    isocore::python::bind_marching_cubes(module);
    isocore::python::bind_surface(module);
    isocore::python::bind_clusters(module);
    isocore::python::bind_marching_cells(module);
    isocore::python::bind_mesh_normals(module);
    isocore::python::bind_statistics(module);
    isocore::python::bind_thinning(module);
    isocore::python::bind_grid_thinning(module);
    isocore::python::bind_rivals(module);
    isocore::python::bind_joining(module);
    isocore::python::bind_pieces(module);
    isocore::python::bind_labels(module);
    isocore::python::bind_simplification(module);
    isocore::python::bind_memory(module);
}
