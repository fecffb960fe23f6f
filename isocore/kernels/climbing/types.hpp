// types.hpp - What climbing is asked for (Options), and what it gives (Mesh).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>

#include "common/array.hpp"

namespace isocore::climbing {

struct Options {
    double isovalue = 0;
    bool below = false;   // inside is sample <= isovalue, for volumes with a negative slope
    bool capped = false;  // everything beyond the border is outside, so that the surface is closed
    int threads = 1;
    int block_size = 16;  // cells along each axis
    // No vertex of marching cubes lies further from the surface than this. The unit is a voxel, or, with `in_world`,
    // that of `spacing`, which is the length of a voxel along each axis.
    double max_error = std::numeric_limits<double>::infinity();
    bool in_world = false;
    std::array<double, 3> spacing{1, 1, 1};
    // Without it no distance is measured: deviations stay 0, and only the flatness of boxes (boxes/flatness.hpp) keeps
    // the error small.
    bool measured = true;
};

// Distances from marching cubes' vertices to the surface: the largest, their sum, and the sum of their squares.
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
    std::size_t blocks = 0, blocks_visited = 0;  // all blocks, and those with samples inside and samples outside
    std::size_t ambiguous_faces = 0, ambiguous_cells = 0;
    std::size_t crossings = 0;      // crossed grid edges, which are the vertices of marching cubes
    std::size_t split_again = 0;    // boxes that were drawn, broke the error bound and were halved
    Deviation in_voxels, in_world;  // in voxels, and in the unit of Options::spacing
};

// Tells where the samples fall at some vertices (x, y, z of each, in samples): unit vectors, NaN where nothing is
// known.
template <class Coordinate>
using Slopes = std::function<Array<float>(const Array<Coordinate>& vertices)>;

template <class Coordinate>
struct Mesh {
    Array<Coordinate> vertices;     // x, y, z of each, in samples
    Array<std::int32_t> triangles;  // three vertex numbers each
    Facts facts;
};

}  // namespace isocore::climbing
