// ambiguities.cpp - The saddle is that of G. M. Nielson, B. Hamann, "The Asymptotic Decider: Resolving the Ambiguity in
// Marching Cubes", IEEE Visualization 1991. Candidates are found on sign bits, 64 faces at a time.
#include "ambiguities/ambiguities.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "common/cube.hpp"
#include "common/parallel.hpp"
#include "samples/sample_types.hpp"
#include "samples/signs.hpp"

namespace isocore::ambiguities {
namespace {

// The faces across `axis` whose corners alternate, one bit each: by their lowest sample, in word w of row (j, k).
std::uint64_t alternating(const SignGrid& signs, int axis, std::size_t j, std::size_t k, std::size_t w) {
    if ((axis != 1 && j + 1 == signs.dims[1]) || (axis != 2 && k + 1 == signs.dims[2])) return 0;
    const SignRow row = signs.row(j, k);
    const std::uint64_t here = row.word(w);
    if (axis == 0) {
        const std::uint64_t right = signs.row(j + 1, k).word(w), up = signs.row(j, k + 1).word(w),
                            both = signs.row(j + 1, k + 1).word(w);
        return (here ^ right) & (here ^ up) & ~(here ^ both) & signs.valid(w);
    }
    const SignRow other = axis == 1 ? signs.row(j, k + 1) : signs.row(j + 1, k);
    return (here ^ row.next_word(w)) & (here ^ other.word(w)) & ~(here ^ other.next_word(w)) & signs.valid(w, 1);
}

template <class Sample>
void add(const GridView<Sample>& samples, double isovalue, bool below, int axis, std::array<std::size_t, 3> at,
         Found& found) {
    const auto across = cube::other_axes(axis);
    const Sample* low = samples.data + samples.index(at[0], at[1], at[2]);
    const std::size_t u = samples.step(across[0]), v = samples.step(across[1]);
    const auto above = [&](std::size_t offset) { return static_cast<double>(low[offset]) - isovalue; };
    const double f00 = above(0), f10 = above(u), f01 = above(v), f11 = above(u + v);
    if (!std::isfinite(f00) || !std::isfinite(f10) || !std::isfinite(f01) || !std::isfinite(f11)) return;
    // The bilinear function has its saddle at (f00 - f01, f00 - f10) / bend; where bend is 0 it is a plane, without
    // one.
    const double bend = f00 + f11 - f10 - f01;
    const auto share = [&](double n) { return bend != 0 ? std::clamp(n / bend, 0.0, 1.0) : 0.5; };
    const double saddle = bend != 0 ? (f00 * f11 - f10 * f01) / bend : 0;
    std::array<double, 3> place{static_cast<double>(at[0]), static_cast<double>(at[1]), static_cast<double>(at[2])};
    place[static_cast<std::size_t>(across[0])] += share(f00 - f01);
    place[static_cast<std::size_t>(across[1])] += share(f00 - f10);
    found.places.insert(found.places.end(), place.begin(), place.end());
    found.distances.push_back(below ? -saddle : saddle);
}

}  // namespace

template <class Sample>
Found find(GridView<Sample> samples, double isovalue, bool below, int threads) {
    const SignGrid signs = classify(samples, isovalue, below, false, threads);
    std::vector<Found> planes(signs.dims[2]);
    parallel_for(threads, planes.size(), [&](std::size_t k) {
        for (std::size_t j = 0; j < signs.dims[1]; ++j) {
            for (int axis = 0; axis < 3; ++axis) {
                for (std::size_t w = 0; w < signs.words; ++w) {
                    for (std::uint64_t left = alternating(signs, axis, j, k, w); left != 0; left &= left - 1) {
                        const std::size_t i = 64 * w + static_cast<std::size_t>(std::countr_zero(left));
                        add(samples, isovalue, below, axis, {i, j, k}, planes[k]);
                    }
                }
            }
        }
    });
    Found all;
    for (const Found& plane : planes) {
        all.places.insert(all.places.end(), plane.places.begin(), plane.places.end());
        all.distances.insert(all.distances.end(), plane.distances.begin(), plane.distances.end());
    }
    return all;
}

#define ISOCORE_INSTANTIATE(Sample) template Found find<Sample>(GridView<Sample>, double, bool, int);
ISOCORE_FOR_EACH_SAMPLE_TYPE(ISOCORE_INSTANTIATE)
#undef ISOCORE_INSTANTIATE

}  // namespace isocore::ambiguities
