// sample_reader.hpp - The one door through which drawing reads samples. Signs tell all that is combinatorial; what
// needs the samples themselves is where an edge is crossed and how an ambiguous face is decided. Both are asked for
// many at a time, so that nothing beyond this door is compiled for each of the eight sample types, at the price of one
// indirect call for a row or a few hundred edges.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "common/grid.hpp"
#include "common/set_bits.hpp"
#include "samples/crossed_edges.hpp"
#include "samples/edge.hpp"
#include "samples/signs.hpp"

namespace isocore {

// Whose bits a word of crossed edges of a row are: bit b is the edge along `axis` that starts at sample `first` + b.
struct WordOfEdges {
    int axis;
    std::size_t first;
};
using CrossedWords = SetBits<WordOfEdges, 32>;

// Samples are numbered as the signs are, padding included.
class SampleReader {
  public:
    virtual ~SampleReader() = default;

    // Where crossed edges of the block at `origin` are crossed, as a share of their way: parts[n] / wholes[n], yet to
    // be divided and clamped to [kClamp, 1 - kClamp] (crossing.hpp).
    virtual void quotients(const Dims& origin, std::span<const Edge> edges, float* parts, float* wholes) const = 0;

    // Writes the vertices (x, y, z in samples of the volume, without padding) of the edges of row (j, k) that `words`
    // holds, in their order, from `out` on; forgets the words and returns the end.
    virtual float* write_vertices(std::size_t j, std::size_t k, CrossedWords& words, float* out) const = 0;
    virtual double* write_vertices(std::size_t j, std::size_t k, CrossedWords& words, double* out) const = 0;

    // The decisions of all alternating faces of a cell with these corner signs, packed as cell_loops::Corners wants
    // them.
    virtual unsigned decide_faces(unsigned corners, const Dims& cell) const = 0;

    // The samples at the corners of a cell that has none in the padding, numbered as in cube.hpp.
    virtual std::array<double, 8> corners(const Dims& cell) const = 0;
};

// Instantiated in sample_reader.cpp for the eight sample types. Signs are those of the samples, for this isovalue, and
// must outlive the reader.
template <class Sample>
class SamplesOf final : public SampleReader {
  public:
    SamplesOf(const GridView<Sample>& samples, const SignGrid& signs, double isovalue)
        : samples_(samples), signs_(signs), isovalue_(isovalue) {}

    void quotients(const Dims& origin, std::span<const Edge> edges, float* parts, float* wholes) const override;
    float* write_vertices(std::size_t j, std::size_t k, CrossedWords& words, float* out) const override;
    double* write_vertices(std::size_t j, std::size_t k, CrossedWords& words, double* out) const override;
    unsigned decide_faces(unsigned corners, const Dims& cell) const override;
    std::array<double, 8> corners(const Dims& cell) const override;

  private:
    GridView<Sample> samples_;
    const SignGrid& signs_;
    double isovalue_;
};

// Writes the vertices of row (j, k) in order, from `out` on, and returns the end: those of the edges along each axis
// whose bits `edges(axis, w)` gives.
template <class Coordinate, class Edges>
Coordinate* write_row_vertices(const SampleReader& samples, const SignGrid& signs, std::size_t j, std::size_t k,
                               Coordinate* out, const Edges& edges) {
    CrossedWords found;
    const auto find = [&](auto axis) {
        for (std::size_t w = 0; w < signs.words; ++w) {
            found.add(edges(axis, w), {axis, 64 * w});
            if (found.full()) out = samples.write_vertices(j, k, found, out);
        }
    };
    find(std::integral_constant<int, 0>{});
    find(std::integral_constant<int, 1>{});
    find(std::integral_constant<int, 2>{});
    return samples.write_vertices(j, k, found, out);
}

// The same for all crossed edges of the row.
template <class Coordinate>
Coordinate* write_row_vertices(const SampleReader& samples, const SignGrid& signs, std::size_t j, std::size_t k,
                               Coordinate* out) {
    return write_row_vertices(samples, signs, j, k, out,
                              [&](auto axis, std::size_t w) { return crossed_edges(signs, axis, j, k, w); });
}

}  // namespace isocore
