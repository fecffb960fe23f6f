// cell_grid.hpp - A grid around a mesh, of cells so large that only so many triangles lie in three of them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "surface/mesh_view.hpp"

namespace isocore {

template <class Real>
class CellGrid {
  public:
    // Of one cell. Halves of coordinates, so that no difference of two is beyond a double.
    explicit CellGrid(const MeshView<Real>& mesh) {
        std::array<double, 3> high;
        low_.fill(std::numeric_limits<double>::max());
        high.fill(std::numeric_limits<double>::lowest());
        for (std::size_t n = 0; n < 3 * mesh.vertex_count; n += 3) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                low_[axis] = std::min(low_[axis], static_cast<double>(mesh.vertices[n + axis]) / 2);
                high[axis] = std::max(high[axis], static_cast<double>(mesh.vertices[n + axis]) / 2);
            }
        }
        for (std::size_t axis = 0; axis < 3; ++axis) longest_ = std::max(longest_, high[axis] - low_[axis]);
        take_some(mesh);
    }

    // As many cells as leave so many triangles, about: the number is told from some of them.
    void fit(double most_triangles) {
        double fewest = 1, finest = kMostCells;
        for (int step = 0; step < kSteps; ++step) {
            cells_ = std::sqrt(fewest * finest);
            (triangles_left() > most_triangles ? finest : fewest) = cells_;
        }
        cells_ = fewest;
    }

    // Down to one cell for all.
    void coarsen(double factor) { cells_ = cells_ / factor < 1 ? 0 : cells_ / factor; }

    // Where a point lies along an axis of the box, whose longest side is 1.
    double share(const Real* point, std::size_t axis) const {
        return longest_ > 0 ? (static_cast<double>(point[axis]) / 2 - low_[axis]) / longest_ : 0;
    }

    // The number of the cell that a point lies in.
    std::uint64_t cell(const Real* point) const {
        std::uint64_t number = 0;
        for (std::size_t axis = 0; axis < 3; ++axis)
            number = number << 21 | static_cast<std::uint64_t>(static_cast<std::int64_t>(share(point, axis) * cells_));
        return number;
    }

  private:
    static constexpr double kMostCells = 1 << 20;  // along an axis: three numbers of them fit into 64 bits
    static constexpr std::size_t kSome = 1 << 15;  // triangles
    static constexpr int kSteps = 16;

    // Some triangles from all over the mesh, the corners of each one after the other.
    void take_some(const MeshView<Real>& mesh) {
        each_ = 1 + mesh.triangle_count / kSome;
        for (std::size_t n = 0; n < mesh.triangle_count; n += each_) {
            for (std::size_t corner = 3 * n; corner < 3 * n + 3; ++corner) {
                const Real* const point = mesh.vertices + 3 * static_cast<std::size_t>(mesh.triangles[corner]);
                some_.insert(some_.end(), point, point + 3);
            }
        }
    }

    double triangles_left() const {
        std::size_t left = 0;
        for (std::size_t n = 0; n < some_.size(); n += 9) {
            const std::uint64_t a = cell(&some_[n]), b = cell(&some_[n + 3]), c = cell(&some_[n + 6]);
            left += static_cast<std::size_t>(a != b && b != c && c != a);
        }
        return static_cast<double>(left) * static_cast<double>(each_);
    }

    std::size_t each_ = 1;
    std::vector<Real> some_;
    std::array<double, 3> low_;
    double longest_ = 0;
    double cells_ = 0;  // along the longest side
};

}  // namespace isocore
