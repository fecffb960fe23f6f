// smooth.hpp - Smooths the shared mesh of a label map. Every vertex stays inside the edge, face or cell of the grid
// that it is the middle of, so that every sample keeps its label and no triangle comes to cut another.
#pragma once

#include "labels/label_mesh.hpp"

namespace isocore::labels {

// `rounds` steps with the two factors of Taubin 1995 by turns: one that smooths, one that undoes the shrinking.
// The same bytes for any number of threads.
void smooth(LabelMesh& mesh, int rounds, int threads);

}  // namespace isocore::labels
