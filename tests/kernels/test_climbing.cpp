// Climbing from C++: small volumes of every kind, so that the sanitizers see every path.
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "check.hpp"
#include "climbing/boxes/dike.hpp"
#include "climbing/climb.hpp"
#include "samples/sample_ranges.hpp"
#include "small_volumes.hpp"

namespace {

using namespace isocore;
using climbing::climb;
using climbing::Options;

constexpr double kNoBound = std::numeric_limits<double>::infinity();

Options options(double isovalue, int block_size, double max_error, int threads) {
    Options out;
    out.isovalue = isovalue;
    out.capped = true;
    out.threads = threads;
    out.block_size = block_size;
    out.max_error = max_error;
    return out;
}

void capped_noise_is_closed_and_does_not_depend_on_threads() {
    for (unsigned seed = 0; seed < 24; ++seed) {
        const Dims dims{2 + seed % 7, 2 + seed / 5 % 6, 2 + seed % 5};
        const auto samples = noise<std::uint8_t>(dims, 3, seed);
        for (int block_size = 1; block_size <= 32; block_size *= 2) {
            for (double max_error : {kNoBound, 0.3, 0.0}) {
                const auto one =
                    climb<std::uint8_t, float>({samples.data(), dims}, options(1, block_size, max_error, 1));
                const auto three =
                    climb<std::uint8_t, float>({samples.data(), dims}, options(1, block_size, max_error, 3));
                CHECK(closed_and_oriented(one));
                CHECK(one.triangles == three.triangles && one.vertices == three.vertices);
                CHECK(one.facts.in_voxels.max <= max_error);
            }
        }
    }
}

// Smooth enough for large boxes, over words and blocks, and no multiple of either.
std::vector<float> waves(const Dims& dims) {
    std::vector<float> samples;
    for (std::size_t k = 0; k < dims[2]; ++k) {
        for (std::size_t j = 0; j < dims[1]; ++j) {
            for (std::size_t i = 0; i < dims[0]; ++i) {
                const auto wave = [](std::size_t at, double length) {
                    return std::sin(static_cast<double>(at) / length);
                };
                samples.push_back(static_cast<float>(wave(i, 7.0) + wave(j, 5.0) + wave(k, 6.0)));
            }
        }
    }
    return samples;
}

void waves_are_closed_in_large_boxes() {
    for (const Dims& dims : {Dims{70, 35, 20}, Dims{33, 66, 17}, Dims{130, 9, 40}}) {
        const auto samples = waves(dims);
        const GridView<float> view{samples.data(), dims};
        const auto ranges = sample_ranges(view, 2);
        for (int block_size : {4, 16, 32}) {
            for (double max_error : {kNoBound, 0.2}) {
                Options asked = options(0.25, block_size, max_error, 2);
                asked.spacing = {1, 2, 0.5};
                asked.in_world = true;
                const auto mesh = climb<float, double>(view, asked);
                CHECK(closed_and_oriented(mesh));
                CHECK(mesh.facts.in_world.max <= max_error);
                CHECK((climb<float, double>(view, asked, ranges.data()).triangles == mesh.triangles));
            }
        }
    }
}

// What the words of DikeBits say, against going along the dike.
template <int N>
void every_dike_has_its_bit() {
    using Bits = climbing::DikeBits<N>;
    using Dikes = climbing::Dike<N>;
    std::mt19937_64 random(N);
    for (int round = 0; round < 200; ++round) {
        const auto signs = static_cast<typename Bits::Word>(random() & random() & Bits::kSamples);
        for (climbing::Label label = 1; label < 2 * N; ++label) {
            const auto has = [&](typename Bits::Word word) { return (word >> Bits::bit(label) & 1) != 0; };
            const int start = Dikes::start(label), end = Dikes::end(label);
            bool any_sample = false, any_step = false;
            int crossings = 0;
            for (int at = start; at <= end; ++at) {
                any_sample = any_sample || (signs >> at & 1);
                if (at == end) break;
                any_step = any_step || (signs >> at & 1);
                crossings += (signs >> at & 1) != (signs >> (at + 1) & 1);
            }
            CHECK(has(Bits::over_samples(signs)) == any_sample);
            CHECK(has(Bits::over_steps(signs)) == any_step);
            CHECK(has(Bits::starting(signs)) == ((signs >> start & 1) != 0));
            CHECK(has(Bits::ending(signs)) == ((signs >> end & 1) != 0));
            CHECK(has(Bits::crossed_again(signs)) == (crossings > 1));
        }
    }
}

}  // namespace

void test_climbing() {
    every_dike_has_its_bit<1>();
    every_dike_has_its_bit<4>();
    every_dike_has_its_bit<16>();
    every_dike_has_its_bit<32>();
    capped_noise_is_closed_and_does_not_depend_on_threads();
    waves_are_closed_in_large_boxes();
}
