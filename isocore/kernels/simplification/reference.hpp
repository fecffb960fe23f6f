// reference.hpp - The reference surface, found by cells, and where it has a border.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "simplification/cell_index.hpp"
#include "simplification/cells.hpp"
#include "simplification/mesh.hpp"
#include "simplification/types.hpp"

namespace isocore::simplification {

template <class Real>
class Reference {
  public:
    Reference(const MeshArrays<Real>& mesh, const Cells& cells);

    const MeshArrays<Real>& mesh() const { return mesh_; }
    const Cells& cells() const { return cells_; }

    // Its triangles, by cell.
    const CellIndex& index() const { return index_; }

    // The three vertices of a triangle.
    const std::int32_t* corners(std::int32_t triangle) const {
        return mesh_.triangles + 3 * static_cast<std::size_t>(triangle);
    }
    // x, y and z of a vertex.
    const Real* place(std::int32_t vertex) const { return mesh_.vertices + 3 * static_cast<std::size_t>(vertex); }
    bool is_in(std::int32_t triangle, std::uint32_t sheet) const {
        return mesh_.sheets == nullptr || (*mesh_.sheets)[static_cast<std::size_t>(triangle)] == sheet;
    }
    // Is a side of the triangle on its sheet's border, or could it be?
    bool may_be_at_border(std::int32_t triangle) const {
        if (!has_border_) return false;
        return at_border_[vertex(triangle, 0)] + at_border_[vertex(triangle, 1)] + at_border_[vertex(triangle, 2)] > 1;
    }

  private:
    std::size_t vertex(std::int32_t triangle, std::size_t n) const {
        return static_cast<std::size_t>(mesh_.triangles[3 * static_cast<std::size_t>(triangle) + n]);
    }
    static CellIndex index_of(const MeshArrays<Real>& mesh, const Cells& cells);
    void find_border();
    void find_curves();

    MeshArrays<Real> mesh_;
    Cells cells_;
    CellIndex index_;
    std::vector<std::uint8_t> at_border_;  // by vertex
    bool has_border_ = false;
};

}  // namespace isocore::simplification
