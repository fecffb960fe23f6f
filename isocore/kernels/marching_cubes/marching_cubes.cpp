// Follows W. E. Lorensen, H. E. Cline, "Marching Cubes: A High Resolution 3D Surface Construction Algorithm",
// SIGGRAPH 1987, with faces decided as G. M. Nielson, B. Hamann, "The Asymptotic Decider: Resolving the Ambiguity in
// Marching Cubes", IEEE Visualization 1991. Counting before writing, so that threads need no locks, is the idea of
// W. Schroeder, R. Maynard, B. Geveci, "Flying Edges", LDAV 2015; here it runs on sign bits, 64 cells at a time.
#include "marching_cubes/marching_cubes.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <stdexcept>
#include <vector>

#include "common/cell_loops.hpp"
#include "common/decider.hpp"
#include "common/edge_vertices.hpp"
#include "common/parallel.hpp"
#include "common/signs.hpp"

namespace isocore::marching_cubes {
namespace {

using Word = std::uint64_t;

std::uint32_t ones(Word word) { return static_cast<std::uint32_t>(std::popcount(word)); }

// The four rows of samples around a row of cells, one word of each, and the same moved on by one sample.
struct Rows {
    std::array<const Word*, 4> row;  // (j, k), (j + 1, k), (j, k + 1), (j + 1, k + 1)
    std::size_t words;

    Rows(const SignGrid& signs, std::size_t j, std::size_t k)
        : row{signs.row(j, k), signs.row(j + 1, k), signs.row(j, k + 1), signs.row(j + 1, k + 1)}, words(signs.words) {}

    Word here(int n, std::size_t w) const { return row[static_cast<std::size_t>(n)][w]; }
    Word next(int n, std::size_t w) const { return next_samples(row[static_cast<std::size_t>(n)], w, words); }
    Word active(std::size_t w, Word valid) const {
        Word any = 0, all = ~Word{0};
        for (int n = 0; n < 4; ++n) {
            const Word a = here(n, w), b = next(n, w);
            any |= a | b;
            all &= a & b;
        }
        return any & ~all & valid;
    }
};

struct LayerCount {
    std::size_t vertices = 0;   // of the edges that start in plane k
    std::size_t triangles = 0;  // of the cells between planes k and k + 1: at most
};

// Every cell draws crossed edges - 2 * loops triangles. Counting one loop per active cell gives a bound that only
// cells of several loops stay below.
class Counter {
  public:
    Counter(const SignGrid& signs, std::vector<RowBase>& bases) : signs_(signs), bases_(bases) {}

    // Fills the bases of plane k with counts (number() turns them into numbers) and returns its sums.
    LayerCount count(std::size_t k) const {
        const std::size_t rows = signs_.dims[1];
        const bool has_cells = k + 1 < signs_.dims[2];
        LayerCount sum;
        for (std::size_t j = 0; j < rows; ++j) {
            RowBase counts{};
            for (std::size_t w = 0; w < signs_.words; ++w) {
                for (int axis = 0; axis < 3; ++axis) counts[static_cast<std::size_t>(axis)] += ones(crossed_edges(signs_, axis, j, k, w));
            }
            bases_[j + rows * k] = counts;
            sum.vertices += std::size_t{counts[0]} + counts[1] + counts[2];
            if (has_cells && j + 1 < rows) sum.triangles += triangles_at_most(j, k);
        }
        return sum;
    }

  private:
    std::size_t triangles_at_most(std::size_t j, std::size_t k) const {
        const Rows rows(signs_, j, k);
        std::size_t crossed = 0, active = 0;
        for (std::size_t w = 0; w < signs_.words; ++w) {
            const Word valid = signs_.valid(w, 1);
            const Word cells = rows.active(w, valid);
            if (cells == 0) continue;
            active += ones(cells);
            for (int n = 0; n < 4; ++n) crossed += ones((rows.here(n, w) ^ rows.next(n, w)) & valid);
            for (const auto [a, b] : kAcross) {
                crossed += ones((rows.here(a, w) ^ rows.here(b, w)) & valid) + ones((rows.next(a, w) ^ rows.next(b, w)) & valid);
            }
        }
        return crossed - 2 * active;
    }

    static constexpr std::array<std::array<int, 2>, 4> kAcross{{{0, 1}, {2, 3}, {0, 2}, {1, 3}}};
    const SignGrid& signs_;
    std::vector<RowBase>& bases_;
};

// Draws the cells of one row after the other, keeping the vertex numbers of the twelve edges at hand.
template <class Sample>
class Drawer {
  public:
    Drawer(const GridView<Sample>& samples, const SignGrid& signs, const std::vector<RowBase>& bases, double isovalue)
        : samples_(samples), signs_(signs), bases_(bases), isovalue_(isovalue) {}

    std::size_t ambiguous_faces = 0, ambiguous_cells = 0;

    // Writes the triangles of cell row (j, k) from `out` on, and returns the end.
    std::int32_t* draw(std::size_t j, std::size_t k, std::int32_t* out) {
        const Rows rows(signs_, j, k);
        const std::size_t row = j + signs_.dims[1] * k, above = row + signs_.dims[1];
        // Numbers of the first crossing, of this row of cells, along: x (4 rows), y (2 planes), z (2 rows).
        std::array<std::uint32_t, 8> base{bases_[row][0],   bases_[row + 1][0], bases_[above][0], bases_[above + 1][0],
                                          bases_[row][1],   bases_[above][1],   bases_[row][2],   bases_[row + 1][2]};
        for (std::size_t w = 0; w < signs_.words; ++w) {
            const Word valid = signs_.valid(w, 1);
            std::array<Word, 4> here, next;
            for (int n = 0; n < 4; ++n) {
                here[static_cast<std::size_t>(n)] = rows.here(n, w);
                next[static_cast<std::size_t>(n)] = rows.next(n, w);
            }
            const std::array<Word, 8> crossed{(here[0] ^ next[0]) & valid, (here[1] ^ next[1]) & valid, (here[2] ^ next[2]) & valid,
                                              (here[3] ^ next[3]) & valid, here[0] ^ here[1],           here[2] ^ here[3],
                                              here[0] ^ here[2],           here[1] ^ here[3]};
            for (Word left = rows.active(w, valid); left != 0; left &= left - 1) {
                const int x = std::countr_zero(left);
                unsigned corners = 0;
                for (unsigned n = 0; n < 4; ++n) corners |= static_cast<unsigned>((here[n] >> x & 1) | (next[n] >> x & 1) << 1) << 2 * n;
                const cell_loops::Case& drawn = decided(corners, 64 * w + static_cast<std::size_t>(x), j, k);
                const auto numbers = edge_numbers(base, crossed, x);
                for (unsigned n = 0; n < 3u * drawn.triangles; ++n) *out++ = static_cast<std::int32_t>(numbers[drawn.edges[n]]);
            }
            for (std::size_t n = 0; n < 8; ++n) base[n] += ones(crossed[n]);
        }
        return out;
    }

  private:
    // The vertex numbers of a cell's twelve edges (cube.hpp's order); those of edges that are not crossed mean nothing.
    static std::array<std::uint32_t, 12> edge_numbers(const std::array<std::uint32_t, 8>& base, const std::array<Word, 8>& crossed, int x) {
        const Word below = (Word{1} << x) - 1;
        std::array<std::uint32_t, 12> numbers;
        for (std::size_t n = 0; n < 4; ++n) numbers[n] = base[n] + ones(crossed[n] & below);
        for (std::size_t n = 4; n < 8; ++n) {
            const std::size_t low = 2 * n - 4;
            numbers[low] = base[n] + ones(crossed[n] & below);
            numbers[low + 1] = numbers[low] + static_cast<std::uint32_t>(crossed[n] >> x & 1);
        }
        return numbers;
    }

    const cell_loops::Case& decided(unsigned corners, std::size_t i, std::size_t j, std::size_t k) {
        const cell_loops::Corners& entry = cell_loops::kTable.corners[corners];
        if (entry.ambiguous == 0) return cell_loops::kTable.cases[entry.first];
        ++ambiguous_cells;
        ambiguous_faces += static_cast<std::size_t>(std::popcount(unsigned{entry.ambiguous}));
        return cell_loops::kTable.cases[entry.first + decide_faces(samples_, signs_.pad, isovalue_, corners, {i, j, k})];
    }

    const GridView<Sample>& samples_;
    const SignGrid& signs_;
    const std::vector<RowBase>& bases_;
    double isovalue_;
};

// Turns the rows' counts into numbers, continuing from plane to plane.
void number_vertices(std::vector<RowBase>& bases, std::size_t total) {
    if (total > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
        throw std::length_error("the surface has more vertices than 2^31 - 1; crop the volume or choose another isovalue");
    }
    std::uint32_t next = 0;
    for (RowBase& row : bases) {
        for (std::uint32_t& axis : row) {
            const std::uint32_t count = axis;
            axis = next;
            next += count;
        }
    }
}

// A run of cell layers: the unit of parallel work. Its place in the outputs is known before it runs.
struct Slab {
    std::size_t first_plane, end_plane;
    std::size_t first_vertex, first_triangle, triangles;
};

std::vector<Slab> make_slabs(const std::vector<LayerCount>& layers, std::size_t work_each) {
    std::vector<Slab> slabs;
    std::size_t vertex = 0, triangle = 0, work = work_each;
    for (std::size_t k = 0; k < layers.size(); ++k) {
        if (work >= work_each) {
            slabs.push_back({k, k, vertex, triangle, 0});
            work = 0;
        }
        slabs.back().end_plane = k + 1;
        vertex += layers[k].vertices;
        triangle += layers[k].triangles;
        work += layers[k].vertices + layers[k].triangles + 64;
    }
    return slabs;
}

// Closes the gaps that the bound left between the slabs' triangles.
void close_gaps(const std::vector<Slab>& slabs, Array<std::int32_t>& triangles) {
    std::size_t end = 0;
    for (const Slab& slab : slabs) {
        if (slab.first_triangle != end) {
            const auto from = triangles.begin() + static_cast<std::ptrdiff_t>(3 * slab.first_triangle);
            std::copy(from, from + static_cast<std::ptrdiff_t>(3 * slab.triangles), triangles.begin() + static_cast<std::ptrdiff_t>(3 * end));
        }
        end += slab.triangles;
    }
    triangles.resize(3 * end);
}

}  // namespace

template <class Sample, class Coordinate>
Mesh<Coordinate> march(GridView<Sample> samples, const Options& options) {
    if (*std::min_element(samples.dims.begin(), samples.dims.end()) < 2) {
        throw std::invalid_argument("marching cubes needs two samples per axis");
    }
    const SignGrid signs = classify(samples, options.isovalue, options.below, options.capped, options.threads);
    const std::size_t rows = signs.dims[1], planes = signs.dims[2];
    std::vector<RowBase> bases(rows * planes);
    std::vector<LayerCount> layers(planes);
    const Counter counter(signs, bases);
    parallel_for(options.threads, planes, [&](std::size_t k) { layers[k] = counter.count(k); });

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
    std::vector<std::array<std::size_t, 2>> ambiguous(slabs.size());
    parallel_for(options.threads, slabs.size(), [&](std::size_t s) {
        Slab& slab = slabs[s];
        Drawer<Sample> drawer(samples, signs, bases, options.isovalue);
        Coordinate* vertex = mesh.vertices.data() + 3 * slab.first_vertex;
        std::int32_t* const first = mesh.triangles.data() + 3 * slab.first_triangle;
        std::int32_t* triangle = first;
        for (std::size_t k = slab.first_plane; k < slab.end_plane; ++k) {
            for (std::size_t j = 0; j < rows; ++j) {
                vertex = write_row_vertices(samples, signs, options.isovalue, j, k, vertex);
                if (k + 1 < planes && j + 1 < rows) triangle = drawer.draw(j, k, triangle);
            }
        }
        slab.triangles = static_cast<std::size_t>(triangle - first) / 3;
        ambiguous[s] = {drawer.ambiguous_faces, drawer.ambiguous_cells};
    });
    close_gaps(slabs, mesh.triangles);
    for (const auto& [faces, cells] : ambiguous) {
        mesh.ambiguous_faces += faces;
        mesh.ambiguous_cells += cells;
    }
    return mesh;
}

#define ISOCORE_INSTANTIATE(Sample)                                            \
    template Mesh<float> march<Sample, float>(GridView<Sample>, const Options&); \
    template Mesh<double> march<Sample, double>(GridView<Sample>, const Options&);
ISOCORE_INSTANTIATE(std::uint8_t)
ISOCORE_INSTANTIATE(std::int8_t)
ISOCORE_INSTANTIATE(std::uint16_t)
ISOCORE_INSTANTIATE(std::int16_t)
ISOCORE_INSTANTIATE(std::uint32_t)
ISOCORE_INSTANTIATE(std::int32_t)
ISOCORE_INSTANTIATE(float)
ISOCORE_INSTANTIATE(double)
#undef ISOCORE_INSTANTIATE

}  // namespace isocore::marching_cubes
