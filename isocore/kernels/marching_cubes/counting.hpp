// counting.hpp - How much each layer of cells will write, so that all of it has a place before anything is written.
#pragma once

#include <cstddef>
#include <vector>

#include "samples/crossed_edges.hpp"
#include "samples/signs.hpp"

namespace isocore::marching_cubes {

struct LayerCount {
    std::size_t vertices = 0;   // of the edges that start in plane k
    std::size_t triangles = 0;  // of the cells between planes k and k + 1: at most
};

// Each cell draws crossed edges - 2 * loops triangles, and 4 more for a tube. So crossed edges - 2, or with `tubes`
// crossed edges, is a bound that only cells of several loops or without a tube stay below.
// Sizes `bases` to one entry per row (j, k) and fills it with counts; number_vertices turns them into numbers.
std::vector<LayerCount> count_layers(const SignGrid& signs, std::vector<RowBase>& bases, bool tubes, int threads);

// Throws std::length_error if there are more than an int32 can name.
void number_vertices(std::vector<RowBase>& bases, std::size_t total);

}  // namespace isocore::marching_cubes
