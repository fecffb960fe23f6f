#include "samples/sample_reader.hpp"

#include <type_traits>

#include "common/crossing.hpp"
#include "samples/decider.hpp"
#include "samples/sample_types.hpp"

namespace isocore {
namespace {

// Where an edge between the padding and the volume is crossed: as near to the volume's own sample as kClamp allows. 0
// for any other edge.
double border_crossing(const SignGrid& signs, int axis, std::size_t start) {
    if (!signs.pad) return 0;
    return start == 0 ? 1 - kClamp : start == signs.dims[static_cast<std::size_t>(axis)] - 2 ? kClamp : 0;
}

// The lower sample of a grid edge that starts at `at` and lies in the volume.
template <class Sample>
const Sample* edge_start(const GridView<Sample>& samples, const SignGrid& signs, const Dims& at) {
    return samples.data + samples.index(at[0] - signs.pad, at[1] - signs.pad, at[2] - signs.pad);
}

// Where the grid edge along `axis` that starts at `at` is crossed, t in [0, 1].
template <class Sample>
double edge_crossing(const GridView<Sample>& samples, const SignGrid& signs, double isovalue, int axis,
                     const Dims& at) {
    if (const double share = border_crossing(signs, axis, at[static_cast<std::size_t>(axis)]); share > 0) return share;
    const Sample* low = edge_start(samples, signs, at);
    return crossing(low[0], low[samples.step(axis)], isovalue);
}

// The same as a quotient. Integers of up to 32 bits and their differences are exact in double, and a quotient of two
// floats is precise enough for tests of flatness and distances; samples that are floats may be huge or not finite, so
// they are divided in double at once.
struct Quotient {
    float part, whole;
};
template <class Sample>
Quotient edge_quotient(const GridView<Sample>& samples, const SignGrid& signs, double isovalue, int axis,
                       const Dims& at) {
    if constexpr (std::is_integral_v<Sample>) {
        if (const double share = border_crossing(signs, axis, at[static_cast<std::size_t>(axis)]); share > 0)
            return {static_cast<float>(share), 1};
        const Sample* low = edge_start(samples, signs, at);
        const double from = static_cast<double>(low[0]);
        return {static_cast<float>(isovalue - from),
                static_cast<float>(static_cast<double>(low[samples.step(axis)]) - from)};
    } else {
        return {static_cast<float>(edge_crossing(samples, signs, isovalue, axis, at)), 1};
    }
}

template <class Sample, class Coordinate>
Coordinate* write_words(const GridView<Sample>& samples, const SignGrid& signs, double isovalue, std::size_t j,
                        std::size_t k, CrossedWords& words, Coordinate* out) {
    const double pad = static_cast<double>(signs.pad), y = static_cast<double>(j) - pad,
                 z = static_cast<double>(k) - pad;
    const Sample* const row = signs.pad ? nullptr : samples.row(j, k);
    const std::array<std::size_t, 3> steps{samples.step(0), samples.step(1), samples.step(2)};
    words.visit([&](const WordOfEdges& word, int bit) {
        const std::size_t i = word.first + static_cast<std::size_t>(bit);
        const double t = row ? crossing(row[i], row[i + steps[static_cast<std::size_t>(word.axis)]], isovalue)
                             : edge_crossing(samples, signs, isovalue, word.axis, {i, j, k});
        *out++ = static_cast<Coordinate>(static_cast<double>(i) - pad + (word.axis == 0 ? t : 0.0));
        *out++ = static_cast<Coordinate>(y + (word.axis == 1 ? t : 0.0));
        *out++ = static_cast<Coordinate>(z + (word.axis == 2 ? t : 0.0));
    });
    return out;
}

}  // namespace

template <class Sample>
void SamplesOf<Sample>::quotients(const Dims& origin, std::span<const Edge> edges, float* parts, float* wholes) const {
    for (std::size_t n = 0; n < edges.size(); ++n) {
        const Edge edge = edges[n];
        Dims at;
        for (std::size_t a = 0; a < 3; ++a) at[a] = origin[a] + static_cast<std::size_t>(edge.at(a));
        const Quotient crossing = edge_quotient(samples_, signs_, isovalue_, static_cast<int>(edge.axis()), at);
        parts[n] = crossing.part;
        wholes[n] = crossing.whole;
    }
}

template <class Sample>
float* SamplesOf<Sample>::write_vertices(std::size_t j, std::size_t k, CrossedWords& words, float* out) const {
    return write_words(samples_, signs_, isovalue_, j, k, words, out);
}
template <class Sample>
double* SamplesOf<Sample>::write_vertices(std::size_t j, std::size_t k, CrossedWords& words, double* out) const {
    return write_words(samples_, signs_, isovalue_, j, k, words, out);
}

template <class Sample>
unsigned SamplesOf<Sample>::decide_faces(unsigned corners, const Dims& cell) const {
    return isocore::decide_faces(samples_, signs_.pad, isovalue_, corners, cell);
}

template <class Sample>
std::array<double, 8> SamplesOf<Sample>::corners(const Dims& cell) const {
    std::array<double, 8> out;
    for (std::size_t c = 0; c < 8; ++c) {
        const Dims at{cell[0] + (c & 1), cell[1] + (c >> 1 & 1), cell[2] + (c >> 2)};
        out[c] = static_cast<double>(samples_.at(at[0] - signs_.pad, at[1] - signs_.pad, at[2] - signs_.pad));
    }
    return out;
}

#define ISOCORE_INSTANTIATE(Sample) template class SamplesOf<Sample>;
ISOCORE_FOR_EACH_SAMPLE_TYPE(ISOCORE_INSTANTIATE)
#undef ISOCORE_INSTANTIATE

}  // namespace isocore
