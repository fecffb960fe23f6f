// module.cpp - `_processor`: what isocore/_kernels.py asks before it loads any of the kernels. A module of its own,
// compiled for the baseline, because a build for this machine alone may have no other that every processor can load.
#include "processor/supports_v3.hpp"

#include <nanobind/nanobind.h>

NB_MODULE(_processor, module) { module.def("supports_v3", &isocore::supports_v3); }
