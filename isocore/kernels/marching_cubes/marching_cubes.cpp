// marching_cubes.cpp - Follows W. E. Lorensen, H. E. Cline, "Marching Cubes: A High Resolution 3D Surface Construction
// Algorithm", SIGGRAPH 1987, with faces decided as G. M. Nielson, B. Hamann, "The Asymptotic Decider: Resolving the
// Ambiguity in Marching Cubes", IEEE Visualization 1991. Counting before writing, so that threads need no locks, is the
// idea of W. Schroeder, R. Maynard, B. Geveci, "Flying Edges", LDAV 2015; here it runs on sign bits, 64 cells at a
// time.
#include "marching_cubes/marching_cubes.hpp"

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "common/gaps.hpp"
#include "common/parallel.hpp"
#include "marching_cubes/counting.hpp"
#include "marching_cubes/drawing.hpp"
#include "samples/row_vertices.hpp"
#include "samples/sample_reader.hpp"
#include "samples/sample_types.hpp"
#include "samples/signs.hpp"

namespace isocore::marching_cubes {
namespace {

// A run of cell layers: the unit of parallel work. Its place in the outputs is known before it runs.
struct Slab {
    std::size_t first_plane, end_plane;
    std::size_t first_vertex, first_triangle;
    std::size_t triangles;  // at most; once drawn, exactly
    std::size_t ambiguous_faces = 0, ambiguous_cells = 0, tubes = 0;
};

std::vector<Slab> make_slabs(const std::vector<LayerCount>& layers, std::size_t work_each) {
    std::vector<Slab> slabs;
    std::size_t vertex = 0, triangle = 0, work = work_each;
    for (std::size_t k = 0; k < layers.size(); ++k) {
        if (work >= work_each) {
            slabs.push_back({k, k, vertex, triangle, 0, 0, 0, 0});
            work = 0;
        }
        slabs.back().end_plane = k + 1;
        slabs.back().triangles += layers[k].triangles;
        vertex += layers[k].vertices;
        triangle += layers[k].triangles;
        work += layers[k].vertices + layers[k].triangles + 64;
    }
    return slabs;
}

template <bool tubes, class Coordinate>
void draw_slabs(const SampleReader& samples, const SignGrid& signs, const std::vector<RowBase>& bases,
                const Options& options, std::vector<Slab>& slabs, Mesh<Coordinate>& mesh) {
    const std::size_t rows = signs.dims[1], planes = signs.dims[2];
    parallel_for(options.threads, slabs.size(), [&](std::size_t s) {
        Slab& slab = slabs[s];
        Drawer<tubes> drawer(samples, signs, bases, options.isovalue, options.below);
        Coordinate* vertex = mesh.vertices.data() + 3 * slab.first_vertex;
        std::int32_t* const first = mesh.triangles.data() + 3 * slab.first_triangle;
        const std::int32_t* const limit = first + 3 * slab.triangles;
        std::int32_t* triangle = first;
        for (std::size_t k = slab.first_plane; k < slab.end_plane; ++k) {
            for (std::size_t j = 0; j < rows; ++j) {
                vertex = write_row_vertices(samples, signs, j, k, vertex);
                if (k + 1 < planes && j + 1 < rows) triangle = drawer.draw(j, k, triangle, limit);
            }
        }
        slab.triangles = static_cast<std::size_t>(triangle - first) / 3;
        slab.ambiguous_faces = drawer.ambiguous_faces;
        slab.ambiguous_cells = drawer.ambiguous_cells;
        slab.tubes = drawer.tubes_drawn;
    });
}

}  // namespace

template <class Sample, class Coordinate>
Mesh<Coordinate> march(GridView<Sample> samples, const Options& options) {
    if (*std::min_element(samples.dims.begin(), samples.dims.end()) < 2) {
        throw std::invalid_argument("marching cubes needs two samples per axis");
    }
    const SignGrid signs = classify(samples, options.isovalue, options.below, options.capped, options.threads);
    const SamplesOf<Sample> reader(samples, signs, options.isovalue);
    std::vector<RowBase> bases;
    const std::vector<LayerCount> layers = count_layers(signs, bases, options.trilinear, options.threads);

    LayerCount total;
    for (const LayerCount& layer : layers) {
        total.vertices += layer.vertices;
        total.triangles += layer.triangles;
    }
    number_vertices(bases, total.vertices);
    Mesh<Coordinate> mesh;
    mesh.vertices.resize(3 * total.vertices);
    mesh.triangles.resize(3 * total.triangles);

    std::vector<Slab> slabs = make_slabs(layers, std::max<std::size_t>(4096, (total.vertices + total.triangles) / 64));
    if (options.trilinear)
        draw_slabs<true>(reader, signs, bases, options, slabs, mesh);
    else
        draw_slabs<false>(reader, signs, bases, options, slabs, mesh);
    close_gaps(slabs, mesh.triangles);
    for (const Slab& slab : slabs) {
        mesh.ambiguous_faces += slab.ambiguous_faces;
        mesh.ambiguous_cells += slab.ambiguous_cells;
        mesh.tubes += slab.tubes;
    }
    return mesh;
}

#define ISOCORE_INSTANTIATE(Sample)                                              \
    template Mesh<float> march<Sample, float>(GridView<Sample>, const Options&); \
    template Mesh<double> march<Sample, double>(GridView<Sample>, const Options&);
ISOCORE_FOR_EACH_SAMPLE_TYPE(ISOCORE_INSTANTIATE)
#undef ISOCORE_INSTANTIATE

}  // namespace isocore::marching_cubes
