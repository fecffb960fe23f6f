// types.hpp - What climbing is asked for, and what comes of it.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "common/array.hpp"

namespace isocore::climbing {

struct Options {
    double isovalue = 0;
    bool below = false;   // inside is sample <= isovalue, for volumes with a negative slope
    bool capped = false;  // treat all beyond the border as outside
    int threads = 1;
    int block_size = 16;
    // No vertex of marching cubes lies further from the surface than this: in voxels, or in the world, where an index
    // step along each axis is as long as its spacing.
    double max_error = std::numeric_limits<double>::infinity();
    bool in_world = false;
    std::array<double, 3> spacing{1, 1, 1};
    bool measured = true;  // without, the deviations stay 0 and the bound rests on the flatness of the boxes alone
};

// Distances of marching cubes' vertices to the surface, over all of them.
struct Deviation {
    double max = 0, sum = 0, squares = 0;
};

inline void add(Deviation& sum, const Deviation& other) {
    sum.max = std::max(sum.max, other.max);
    sum.sum += other.sum;
    sum.squares += other.squares;
}

struct Facts {
    std::size_t highrices = 0;
    std::size_t blocks = 0, blocks_visited = 0;  // visited: samples on both sides
    std::size_t ambiguous_faces = 0, ambiguous_cells = 0;
    std::size_t crossings = 0;    // vertices of marching cubes
    std::size_t split_again = 0;  // boxes that broke the error bound after meshing
    Deviation in_voxels, in_world;
};

template <class Coordinate>
struct Mesh {
    Array<Coordinate> vertices;     // x, y, z, x, y, z ...
    Array<std::int32_t> triangles;  // three vertices each
    Facts facts;
};

}  // namespace isocore::climbing
