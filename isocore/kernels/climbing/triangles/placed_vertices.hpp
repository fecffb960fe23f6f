// placed_vertices.hpp - The vertices of the mesh as float32, relative to an origin near by. Whether the mesh stores
// floats or doubles is known in this class alone.
#pragma once

#include <cstddef>
#include <cstdint>

#include "common/vectors.hpp"

namespace isocore::climbing {

class PlacedVertices {
  public:
    // places: x, y, z of each vertex, in samples. directions: where the samples fall there, 0 where that is not known;
    // or null. They must outlive this object.
    PlacedVertices(const float* places, const float* directions) : floats_(places), directions_(directions) {}
    PlacedVertices(const double* places, const float* directions) : doubles_(places), directions_(directions) {}

    // A vertex minus an origin of whole samples near it, so that float32 keeps its precision. The difference is taken
    // in double, where it is exact for two floats: it is rounded once, in whatever type the vertices are stored.
    Spot from(const Vector<double>& origin, std::size_t vertex) const {
        return floats_ ? from(origin, floats_ + 3 * vertex) : from(origin, doubles_ + 3 * vertex);
    }

    bool have_directions() const { return directions_ != nullptr; }
    Spot direction(std::int32_t vertex) const {
        const float* at = directions_ + 3 * static_cast<std::size_t>(vertex);
        return {at[0], at[1], at[2]};
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
    const float* directions_ = nullptr;
};

}  // namespace isocore::climbing
