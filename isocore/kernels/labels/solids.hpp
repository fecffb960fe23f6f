// solids.hpp - One label after the other as a closed surface of its own, from the mesh that all labels share.
#pragma once

#include <cstddef>
#include <cstdint>

#include "common/array.hpp"
#include "labels/label_mesh.hpp"

namespace isocore::labels {

struct Solid {
    Array<float> vertices;          // x, y, z, in index space
    Array<std::int32_t> triangles;  // three vertices each, counter-clockwise seen from outside the label
    Array<std::int32_t> shared;     // per vertex: its number in the shared mesh
};

// The pairs of ranks that share a border, each once, the higher first: in ascending order, two numbers a pair.
Array<std::uint32_t> neighbours(const LabelMesh& mesh);

// Which triangles have a label on one of their sides: a list per rank.
class Solids {
  public:
    Solids() = default;
    // Ranks of `mesh` are below `ranks`.
    Solids(const LabelMesh& mesh, std::size_t ranks);

    std::size_t triangles_of(std::size_t rank) const { return starts_[rank + 1] - starts_[rank]; }
    // A closed, oriented 2-manifold. Where the label passes through a cell's middle more than once, the vertex there
    // occurs once for each time. Throws std::out_of_range for a rank that there is not.
    Solid solid(const LabelMesh& mesh, std::size_t rank) const;

  private:
    Array<std::uint32_t> sided_;  // twice a triangle's number, plus 1 if the label is ahead of it
    Array<std::size_t> starts_;
};

}  // namespace isocore::labels
