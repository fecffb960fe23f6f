// The three shared rules: who is inside, where an edge is crossed, how a face is decided.
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <limits>

#include "check.hpp"
#include "common/crossing.hpp"

namespace {

using namespace isocore;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

void inside_agrees_with_the_comparison_in_double() {
    for (double isovalue : {-1e9, -129.0, -128.0, -0.5, 0.0, 3.0, 3.5, 126.9, 127.0, 127.5, 1e9}) {
        const Inside<std::int8_t> at_or_above(isovalue, false), at_or_below(isovalue, true);
        for (int sample = -128; sample <= 127; ++sample) {
            CHECK(at_or_above(static_cast<std::int8_t>(sample)) == (sample >= isovalue));
            CHECK(at_or_below(static_cast<std::int8_t>(sample)) == (sample <= isovalue));
        }
    }
}

void a_float_is_compared_as_the_double_it_stands_for() {
    const float third = 1.0f / 3;
    CHECK(!Inside<float>(1.0 / 3, true)(third));  // float(1/3) lies above 1/3
    CHECK(Inside<float>(1.0 / 3, false)(third));
    CHECK(!Inside<float>(1.0 / 3, false)(std::nextafter(third, 0.0f)));
}

void what_is_not_finite_is_outside() {
    for (bool below : {false, true}) {
        const Inside<double> inside(0.0, below);
        CHECK(!inside(kNan) && !inside(kInfinity) && !inside(-kInfinity));
    }
    CHECK(crossing(kNan, 3.0, 1.0) == 0.5);
    CHECK(crossing(kInfinity, 3.0, 1.0) == 0.5);
    CHECK(!inside_corners_joined(1.0, 1.0, -kInfinity, 0.0, 0.5));
}

void a_crossing_stays_away_from_the_ends() {
    CHECK(crossing<std::uint8_t>(4, 0, 4.0) == kClamp);
    CHECK(crossing<std::uint8_t>(0, 4, 4.0) == 1 - kClamp);
    CHECK(crossing<std::uint8_t>(0, 4, 1.0) == 0.25);
    CHECK(crossing(-1.7e308, 1.7e308, 0.0) == 0.5);
}

void a_saddle_on_the_isovalue_joins() {
    CHECK(inside_corners_joined(1, 1, -1, -1, 0));
    CHECK(inside_corners_joined(2, 1, -1, -1, 0));
    CHECK(!inside_corners_joined(1, 1, -2, -1, 0));
}

void a_face_is_joined_alike_at_every_scale() {
    for (const double scale : {0x1p-1040, 0x1p-700, 0x1p-500, 1.0, 0x1p500, 0x1p700, 0x1p1020}) {
        for (int in0 = 1; in0 < 4; ++in0) {
            for (int in1 = 1; in1 < 4; ++in1) {
                for (int out0 = -3; out0 < 0; ++out0) {
                    const bool joined = in0 * in1 >= out0 * -2;
                    CHECK(inside_corners_joined(in0 * scale, in1 * scale, out0 * scale, -2 * scale, 0) == joined);
                    CHECK(inside_corners_joined((in0 + 4) * scale, (in1 + 4) * scale, (out0 + 4) * scale, 2 * scale,
                                                4 * scale) == joined);
                }
            }
        }
    }
}

}  // namespace

void test_crossing() {
    inside_agrees_with_the_comparison_in_double();
    a_float_is_compared_as_the_double_it_stands_for();
    what_is_not_finite_is_outside();
    a_crossing_stays_away_from_the_ends();
    a_saddle_on_the_isovalue_joins();
    a_face_is_joined_alike_at_every_scale();
}
