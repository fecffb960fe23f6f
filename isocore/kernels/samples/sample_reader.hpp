// sample_reader.hpp - The one door through which drawing reads samples. Signs tell all that is combinatorial; the
// samples themselves are needed for where an edge is crossed and how an ambiguous face is decided, and nothing else:
//
//     signs  -------------------------------------->  which boxes, loops, triangles
//     samples --> SamplesOf<uint8> ... <double> -+
//                                  SampleReader  +->  quotients (positions), face decisions, rows of vertices
//
// So nothing beyond this door is compiled once for each of the eight sample types. Its functions are virtual, but
// answer for many edges at a time: one indirect call for a row of vertices or for a few hundred edges.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "common/grid.hpp"
#include "common/set_bits.hpp"
#include "samples/edge.hpp"
#include "samples/signs.hpp"

namespace isocore {

// Tells which edges of a row the bits of a word are: bit b is the edge along `axis` that starts at sample `first` + b.
struct WordOfEdges {
    int axis;
    std::size_t first;
};
using CrossedWords = SetBits<WordOfEdges, 32>;

// Samples are numbered as in the grid of signs, padding included.
class SampleReader {
  public:
    virtual ~SampleReader() = default;

    // Where crossed edges of the block at `origin` are crossed, t in [0, 1] along each edge, as quotients: the caller
    // divides parts[n] by wholes[n], many at once, and clamps to [kClamp, 1 - kClamp] (crossing.hpp). For an edge from
    // sample 10 to sample 30 and isovalue 15 they are 5 and 20.
    virtual void quotients(const Dims& origin, std::span<const Edge> edges, float* parts, float* wholes) const = 0;

    // Writes the vertices (x, y, z in samples of the volume, without padding) of the edges of row (j, k) that `words`
    // holds, in their order, from `out` on; forgets the words and returns the end.
    virtual float* write_vertices(std::size_t j, std::size_t k, CrossedWords& words, float* out) const = 0;
    virtual double* write_vertices(std::size_t j, std::size_t k, CrossedWords& words, double* out) const = 0;

    // The decisions of all alternating faces of a cell with these corner signs, packed as in decider.hpp.
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

}  // namespace isocore
