// slab.hpp - Extracts a few layers of cells of a label map. Planes of samples pass by one after the other as ranks,
// with a layer of background around each, and only the two planes of the present layer of cells are kept.
//
// Vertices are numbered as they are met: plane by plane those of the plane's own edges and faces, and, between two
// planes, first those of edges and faces that stand on the lower plane, last those of cells. The plane below a slab
// belongs to the slab before it: its vertices have negative numbers here, counted from the end of that plane.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include "common/array.hpp"
#include "labels/cell_disks.hpp"
#include "labels/label_mesh.hpp"

namespace isocore::labels {

// The disks of cells that were met so far. Most cells show two labels, and have a table of their own.
class DiskCache {
  public:
    DiskCache();
    // By the corners whose label ranks higher, a bit each.
    const CellDisks& of_two(unsigned higher) const { return of_two_[higher]; }
    const CellDisks& of(const CornerRanks& ranks);

  private:
    std::vector<CellDisks> of_two_;
    std::unordered_map<std::uint32_t, CellDisks> of_more_;
};

struct Sizes {
    std::size_t vertices = 0, triangles = 0, curves = 0;
};

// What one slab has drawn, with vertices numbered from 0.
struct SlabMesh : LabelMesh {
    std::size_t last_middles = 0;  // vertices in the middles of cells of its last layer
};

// Rank: an unsigned type that holds all ranks. The narrower, the more samples are surveyed at once.
template <class Rank>
class Slab {
  public:
    // `dims`: samples with the layer of background, which is two more along each axis.
    explicit Slab(const Dims& dims);
    Slab(const Slab&) = delete;
    Slab& operator=(const Slab&) = delete;

    // Draws the layers of cells `first` to `last` - 1. load(plane, out) writes a plane's ranks, dims[0] * dims[1] of
    // them.
    template <class Load>
    SlabMesh draw(std::size_t first, std::size_t last, const Load& load) {
        make_room();
        load(first, low_.ranks.data());
        survey_plane(low_);
        number_plane(low_, first, first != 0);
        for (std::size_t layer = first; layer < last; ++layer) {
            load(layer + 1, high_.ranks.data());
            survey_plane(high_);
            survey_layer();
            number_layer(layer);
            number_plane(high_, layer + 1, false);
            draw_layer(layer);
            std::swap(low_, high_);
        }
        return finished();
    }

  private:
    using Numbers = std::array<std::int32_t, 3>;
    // Of each sample: is the edge to the next along x (bit 0) and along y (bit 1) crossed, and does the face between
    // them have a vertex (bit 2)? And the numbers of their vertices.
    struct Plane {
        std::vector<Rank> ranks;
        std::vector<std::uint8_t> marks;
        Numbers* numbers;  // along x, along y, in the face
    };

    void make_room();
    SlabMesh finished();
    void survey_plane(Plane& plane) const;
    void survey_layer();
    void number_plane(Plane& plane, std::size_t k, bool of_slab_before);
    void number_layer(std::size_t k);
    void draw_layer(std::size_t k);
    void draw_cell(std::size_t at, std::size_t i, std::size_t j, std::size_t k);
    void write_cell(const CellDisks& disks, const CornerRanks& ranks, std::size_t at, std::int32_t middle);
    std::int32_t add_vertex(std::size_t i, std::size_t j, std::size_t k, Element element);
    // Calls visit(place, i, j) for every sample of a plane that has a mark.
    template <class Visit>
    void for_each_marked(const std::vector<std::uint8_t>& marks, const Visit& visit) const;

    Dims dims_;
    std::size_t row_, plane_;  // samples of a row, of a plane
    Plane low_, high_;
    std::vector<std::uint8_t> upright_marks_;  // as a plane's, of edges along z, faces of axis 1 (bit 1) and 0 (bit 2)
    Numbers* upright_numbers_;
    Array<Numbers> numbers_;  // of both planes and what stands between them, in one piece
    DiskCache cache_;
    SlabMesh mesh_;
    Sizes expected_;  // a little more than of the slab before
};

}  // namespace isocore::labels
