// bindings.hpp - One function per algorithm that adds its names to the module. The files in this folder are
// the only ones that know Python: parameters spell out dtype, rank, order and device; inputs are const and
// never converted; kernels run with the GIL released; results move out without a copy.
#pragma once

#include <nanobind/nanobind.h>

namespace isocore::python {

void bind_marching_cubes(nanobind::module_& module);
void bind_surface(nanobind::module_& module);
void bind_clusters(nanobind::module_& module);
void bind_marching_cells(nanobind::module_& module);
void bind_mesh_normals(nanobind::module_& module);
void bind_statistics(nanobind::module_& module);
void bind_thinning(nanobind::module_& module);
void bind_climbing(nanobind::module_& module);
void bind_grid_thinning(nanobind::module_& module);
void bind_rivals(nanobind::module_& module);
void bind_ambiguities(nanobind::module_& module);
void bind_joining(nanobind::module_& module);
void bind_pieces(nanobind::module_& module);
void bind_labels(nanobind::module_& module);
void bind_simplification(nanobind::module_& module);
void bind_memory(nanobind::module_& module);

}  // namespace isocore::python
