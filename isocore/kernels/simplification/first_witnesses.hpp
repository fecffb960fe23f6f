// first_witnesses.hpp - Which of the reference's vertices each triangle answers for when simplification begins.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "common/array.hpp"
#include "common/vectors.hpp"
#include "simplification/cell_index.hpp"
#include "simplification/cubes.hpp"
#include "simplification/types.hpp"

namespace isocore::simplification {

// Vertices of the reference, by number, in ascending order for each triangle of the input.
class FirstWitnesses {
  public:
    FirstWitnesses() = default;  // none
    // nearest: of each of the vertices the triangle, or kNone.
    FirstWitnesses(const Array<std::int32_t>& vertices, const Array<std::int32_t>& nearest, std::size_t triangles);

    std::span<const std::int32_t> of(std::int32_t triangle) const {
        if (starts_.empty()) return {};
        const auto t = static_cast<std::size_t>(triangle);
        return {vertices_.data() + starts_[t], vertices_.data() + starts_[t + 1]};
    }
    std::size_t size() const { return vertices_.size(); }

  private:
    Array<std::uint32_t> starts_;  // of each triangle, and one more
    Array<std::int32_t> vertices_;
};

// The triangles of a mesh, by the cubes that they touch.
template <class Real>
CellIndex index_by_cubes(const MeshArrays<Real>& mesh, const Cubes& cubes);

// Those of the reference's vertices that are none of the input's, each with the triangle that is nearest to it within
// the limit, or nearest of all. index: the input's triangles, by cubes.
template <class Real>
FirstWitnesses find_witnesses(const MeshArrays<Real>& input, const Cubes& cubes, const CellIndex& index,
                              const MeshArrays<Real>& reference, const Spot& stretch, float limit, int threads);

}  // namespace isocore::simplification
