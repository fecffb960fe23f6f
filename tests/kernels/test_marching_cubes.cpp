// Marching cubes from C++: small volumes, so that the sanitizers see every path.
#include <cstdint>
#include <initializer_list>

#include "check.hpp"
#include "marching_cubes/marching_cubes.hpp"
#include "small_volumes.hpp"

namespace {

using namespace isocore;
using marching_cubes::march;
using marching_cubes::Options;

template <class Sample>
void capped_noise_is_closed() {
    for (unsigned seed = 0; seed < 40; ++seed) {
        const Dims dims{2 + seed % 5, 2 + seed / 5 % 4, 2 + seed % 3};
        const auto samples = noise<Sample>(dims, 3, seed);
        const auto mesh = march<Sample, float>({samples.data(), dims}, Options{1.0, seed % 2 == 1, true, false, 1});
        CHECK(closed_and_oriented(mesh));
    }
}

void rows_longer_than_a_word_are_closed_and_do_not_depend_on_threads() {
    for (std::size_t length : {63u, 64u, 65u, 126u, 127u, 128u, 130u}) {
        const Dims dims{length, 5, 7};
        const auto samples = noise<std::uint8_t>(dims, 4, static_cast<unsigned>(length));
        const auto one = march<std::uint8_t, float>({samples.data(), dims}, Options{2.0, false, true, false, 1});
        const auto three = march<std::uint8_t, float>({samples.data(), dims}, Options{2.0, false, true, false, 3});
        CHECK(closed_and_oriented(one));
        CHECK(one.triangles == three.triangles && one.vertices == three.vertices);
    }
}

void the_whole_range_of_isovalues_is_harmless() {
    const Dims dims{3, 3, 3};
    const auto samples = noise<std::int32_t>(dims, 5, 1);
    for (double isovalue : {-1e300, -1.0, 0.0, 4.0, 5.0, 1e300}) {
        CHECK(closed_and_oriented(
            march<std::int32_t, double>({samples.data(), dims}, Options{isovalue, false, true, false, 2})));
    }
}

}  // namespace

void test_marching_cubes() {
    capped_noise_is_closed<std::uint8_t>();
    capped_noise_is_closed<std::int16_t>();
    capped_noise_is_closed<float>();
    capped_noise_is_closed<double>();
    rows_longer_than_a_word_are_closed_and_do_not_depend_on_threads();
    the_whole_range_of_isovalues_is_harmless();
}
