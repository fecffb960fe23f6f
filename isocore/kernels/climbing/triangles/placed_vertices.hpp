// placed_vertices.hpp - The vertices of the mesh as float32, relative to an origin near by. Whether the mesh stores
// floats or doubles is known in this class alone.
#pragma once

#include <cstddef>

#include "common/vectors.hpp"

namespace isocore::climbing {

class PlacedVertices {
  public:
    // places: x, y, z of each vertex, in samples. They must outlive this object.
    explicit PlacedVertices(const float* places) : floats_(places) {}
    explicit PlacedVertices(const double* places) : doubles_(places) {}

    // A vertex minus an origin of whole samples near it, so that float32 keeps its precision. The difference is taken
    // in double, where it is exact for two floats: it is rounded once, in whatever type the vertices are stored.
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
