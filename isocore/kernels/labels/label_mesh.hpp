// label_mesh.hpp - The surfaces between all labels of a volume, as one mesh in which neighbours share their border
// triangle by triangle. Its vertices are middles of edges, faces and cells of the grid of samples (cell_disks.hpp), in
// index space; beyond the volume lies one layer of background, which closes every label.
#pragma once

#include <cstddef>
#include <cstdint>

#include "common/array.hpp"
#include "common/grid.hpp"
#include "labels/ranks.hpp"

namespace isocore::labels {

// Where a vertex may move: along the axes whose bit (1, 2, 4) is set, inside the edge, face or cell that it is the
// middle of. kStays: not at all, because several parts of a cell's disks meet there.
using Element = std::uint8_t;
constexpr Element kStays = 8;
constexpr Element kCell = 7;
constexpr Element free_axes(Element element) { return element & kCell; }
constexpr bool is_edge(Element element) {
    return free_axes(element) == 1 || free_axes(element) == 2 || free_axes(element) == 4;
}

struct LabelMesh {
    Array<float> vertices;          // x, y, z
    Array<Element> elements;        // one per vertex
    Array<std::int32_t> triangles;  // three vertices each, counter-clockwise seen from the side of lower rank
    Array<std::uint32_t> sides;     // two ranks per triangle: the higher, which lies behind it, then the lower
    Array<std::int32_t> curves;     // where three labels and more meet: pairs of a face's middle and a cell's middle
};

// The same bytes for any number of threads. Throws std::length_error if there are more vertices than an int32 can name.
template <class Sample>
LabelMesh extract(GridView<Sample> samples, const RankTable& ranks, int threads);

}  // namespace isocore::labels
