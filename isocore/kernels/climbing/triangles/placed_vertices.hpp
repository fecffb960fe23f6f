// placed_vertices.hpp - The vertices of the mesh, seen from near by. Whether they are floats or doubles is known here
// alone.
#pragma once

#include <cstddef>

#include "climbing/vectors.hpp"

namespace isocore::climbing {

class PlacedVertices {
  public:
    explicit PlacedVertices(const float* places) : floats_(places) {}
    explicit PlacedVertices(const double* places) : doubles_(places) {}

    // A vertex relative to an origin that is whole, in samples, and near by, so that float keeps its digits. The
    // difference of two floats is exact in double, so that it is rounded once, however vertices are stored.
    Spot from(const Vector<double>& origin, std::size_t vertex) const {
        return floats_ ? from(origin, floats_ + 3 * vertex) : from(origin, doubles_ + 3 * vertex);
    }

  private:
    template <class Coordinate>
    static Spot from(const Vector<double>& origin, const Coordinate* place) {
        Spot out;
        for (std::size_t a = 0; a < 3; ++a) out[a] = static_cast<float>(static_cast<double>(place[a]) - origin[a]);
        return out;
    }

    const float* floats_ = nullptr;
    const double* doubles_ = nullptr;
};

}  // namespace isocore::climbing
