// grid_thinning.hpp - Volume thinning of voxel volumes: the public functions. Three to four times slower than marching
// cubes (README.md says why). The cells are hexahedra that need no adjacency arrays, since index arithmetic finds every
// neighbour. With `capped` the volume has one more layer of outside samples on every side.
// A cell is named by its place i + cells_i * (j + cells_j * k), padding included.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "common/array.hpp"
#include "common/grid.hpp"

namespace isocore::thinning {

struct GridOptions {
    bool below = false;  // inside is sample <= isovalue, for volumes with a negative slope
    bool capped = false;
};

// A skeleton cell meets the isosurface iff low < isovalue <= high; with `below` low, high and the isovalue are all
// negated.
struct GridSkeleton {
    Array<std::int32_t> cells;  // by ascending low
    Array<double> low, high;
    std::array<std::size_t, 7> classes{};       // skeleton cells by the number of their face neighbours among them
    std::size_t extrema = 0, volume_cells = 0;  // vertices that are a local extremum; all cells, padding included
};

// Throws std::length_error if an int32 cannot name the cells.
template <class Sample>
GridSkeleton thin_grid(GridView<Sample> samples, const GridOptions& options);

struct GridSkeletonView {
    const std::int32_t* cells;
    const double *low, *high;
    std::size_t size;
    // Scratch that the caller provides as zeros, one per cell of the volume. During a call it holds when the walk
    // visited the cell, counted from 1; afterwards it is all zeros again, also if the call throws.
    std::int32_t* place;
};

struct GridMesh {
    Array<double> vertices;  // x, y, z, in index space
    Array<std::int32_t> triangles;
    std::size_t seeds = 0, visited = 0, ambiguous_faces = 0, ambiguous_cells = 0;
};

// The vertices and triangles of marching cubes, in another order.
template <class Sample>
GridMesh propagate_grid(GridView<Sample> samples, const GridSkeletonView& skeleton, double isovalue,
                        const GridOptions& options, int threads);

}  // namespace isocore::thinning
