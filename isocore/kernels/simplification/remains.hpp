// remains.hpp - What is left of a part of a mesh once edges inside its box were contracted: as little as the next box
// needs to know. All numbers are those of the whole, but in rings.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/array.hpp"
#include "simplification/mesh.hpp"

namespace isocore::simplification {

struct Remains {
    struct Face {
        std::array<std::int32_t, 3> corners;
        std::int32_t number;
        std::uint32_t at;         // its number in the part
        std::uint32_t witnesses;  // how many it has
        float proved;
    };

    // The vertices of the box that are not gone, or lie on a curve: its course is asked for later.
    std::vector<std::int32_t> vertices;
    std::vector<Vertex> states;                      // of each; their rings come one after the other:
    std::vector<std::int32_t> rings;                 // places in `faces`
    std::vector<bool> has_quadric;                   // of each
    std::vector<Quadric> quadrics;                   // of those that have one
    std::vector<Face> faces;                         // the triangles that touch the box
    std::vector<std::int32_t> witnesses;             // of each in turn: vertices
    std::vector<std::array<std::int32_t, 2>> along;  // of each vertex on a curve
    std::size_t first_numbered = 0, triangles = 0;   // of the part

    void shrink_to_fit();
};

}  // namespace isocore::simplification
