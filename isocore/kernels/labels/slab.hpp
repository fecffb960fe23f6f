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
#include <utility>
#include <vector>

#include "common/array.hpp"
#include "labels/cell_disks.hpp"
#include "labels/label_mesh.hpp"
#include "labels/marks.hpp"

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
    // them. vertices: how many there will be, about.
    template <class Load>
    SlabMesh draw(std::size_t first, std::size_t last, std::size_t vertices, const Load& load) {
        make_room(vertices);
        load(first, low_.ranks.data());
        survey_plane(low_);
        if (first == 0)
            add_vertices(low_.marks, first, kOfPlane);
        else  // of the slab before
            low_.marks.number(-static_cast<std::int32_t>(low_.marks.vertices()), [](std::size_t, unsigned) {});
        for (std::size_t layer = first; layer < last; ++layer) {
            load(layer + 1, high_.ranks.data());
            survey_plane(high_);
            survey_layer();
            add_vertices(upright_, layer, kUpright);
            add_vertices(high_.marks, layer + 1, kOfPlane);
            draw_layer(layer);
            std::swap(low_, high_);
        }
        return std::move(mesh_);
    }

  private:
    static constexpr std::array<Element, 3> kOfPlane{1, 2, 3}, kUpright{4, 5, 6};

    // Of each sample: is the edge to the next along x (bit 0) and along y (bit 1) crossed, and does the face between
    // them have a vertex (bit 2)?
    struct Plane {
        std::vector<Rank> ranks;
        Marks marks;
    };

    void make_room(std::size_t vertices);
    void survey_plane(Plane& plane) const;
    void survey_layer();
    void draw_layer(std::size_t k);
    void draw_cell(std::size_t at, std::size_t i, std::size_t j, std::size_t k);
    void write_cell(const CellDisks& disks, const CornerRanks& ranks, std::size_t at, std::int32_t middle);
    // Adds and numbers all vertices of marked samples, one of these elements for each bit.
    void add_vertices(Marks& marks, std::size_t k, const std::array<Element, 3>& elements);
    void set_vertex(std::size_t number, std::size_t i, std::size_t j, std::size_t k, Element element);

    Dims dims_;
    std::size_t row_, plane_;  // samples of a row, of a plane
    Plane low_, high_;
    Marks upright_;  // as a plane's, of edges along z, faces of axis 1 (bit 1) and 0 (bit 2)
    DiskCache cache_;
    SlabMesh mesh_;
};

}  // namespace isocore::labels
