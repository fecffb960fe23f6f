// Eight floats at once, in registers of every width there is, against the same rules on one float after the other.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>

#include "check.hpp"
#include "common/lanes.hpp"

namespace {

using namespace isocore;
using Row = std::array<float, kLanes>;
using Limits = std::numeric_limits<float>;

std::uint32_t bits_of(float value) { return std::bit_cast<std::uint32_t>(value); }
bool is_same(float a, float b) { return bits_of(a) == bits_of(b); }
// Which NaN an operation yields is the compiler's choice.
bool is_same_result(float a, float b) { return is_same(a, b) || (std::isnan(a) && std::isnan(b)); }

// Any bits, or a value with rules of its own, or one near 1 so that products and sums must be rounded.
float random_float(std::mt19937& random) {
    constexpr std::array kSpecial{0.0f,
                                  -0.0f,
                                  1.0f,
                                  -1.0f,
                                  Limits::infinity(),
                                  -Limits::infinity(),
                                  Limits::quiet_NaN(),
                                  -Limits::quiet_NaN(),
                                  Limits::denorm_min(),
                                  -Limits::denorm_min(),
                                  Limits::min(),
                                  Limits::max(),
                                  Limits::lowest()};
    switch (random() % 3) {
        case 0:
            return kSpecial[random() % kSpecial.size()];
        case 1:
            return std::bit_cast<float>(static_cast<std::uint32_t>(random()));
        default:
            return std::uniform_real_distribution<float>(-2, 2)(random);
    }
}
Row random_row(std::mt19937& random) {
    Row out;
    for (float& lane : out) lane = random_float(random);
    return out;
}
// Half of the lanes of another row, so that equal ones meet.
Row like(const Row& row, std::mt19937& random) {
    Row out = random_row(random);
    for (std::size_t n = 0; n < kLanes; ++n) {
        if (random() % 2) out[n] = row[n];
    }
    return out;
}

template <class Same, class Rule>
void check_lanes(const Row& found, const Same& same, const Rule& expected) {
    for (std::size_t n = 0; n < kLanes; ++n) CHECK(same(found[n], expected(n)));
}
template <class Mask, class Rule>
void check_mask(const Mask& found, const Rule& expected) {
    unsigned bits = 0;
    for (std::size_t n = 0; n < kLanes; ++n) bits |= static_cast<unsigned>(expected(n)) << n;
    CHECK(found.bits() == bits);
    CHECK(found.any() == (bits != 0));
}

template <std::size_t width>
void arithmetic_is_that_of_single_floats(std::mt19937& random) {
    using Eight = FloatLanes<width>;
    const Row p = random_row(random), q = like(p, random), r = random_row(random);
    const Eight a(p.data()), b(q.data()), c(r.data());
    check_lanes((a + b).each(), is_same_result, [&](std::size_t n) { return p[n] + q[n]; });
    check_lanes((a - b).each(), is_same_result, [&](std::size_t n) { return p[n] - q[n]; });
    check_lanes((a * b).each(), is_same_result, [&](std::size_t n) { return p[n] * q[n]; });
    check_lanes((a / b).each(), is_same_result, [&](std::size_t n) { return p[n] / q[n]; });
    check_lanes(root(a).each(), is_same_result, [&](std::size_t n) { return std::sqrt(p[n]); });
    check_lanes((a * c + b).each(), is_same_result, [&](std::size_t n) {
        const volatile float product = p[n] * r[n];  // so that no compiler may fuse it with the sum
        return product + q[n];
    });
}

template <std::size_t width>
void comparisons_are_those_of_single_floats(std::mt19937& random) {
    using Eight = FloatLanes<width>;
    const Row p = random_row(random), q = like(p, random), r = like(q, random);
    const Eight a(p.data()), b(q.data()), c(r.data());
    check_mask(a < b, [&](std::size_t n) { return p[n] < q[n]; });
    check_mask(a <= b, [&](std::size_t n) { return p[n] <= q[n]; });
    check_mask(a == b, [&](std::size_t n) { return p[n] == q[n]; });
    check_mask((a <= b) & (b <= c), [&](std::size_t n) { return p[n] <= q[n] && q[n] <= r[n]; });
    check_mask((a < b) | (b < c), [&](std::size_t n) { return p[n] < q[n] || q[n] < r[n]; });
    check_mask(a < a, [](std::size_t) { return false; });

    Row sets;
    for (float& lane : sets) lane = std::bit_cast<float>(1u << random() % 8 | 1u << (20 + random() % 8));
    const Row others = like(Row{}, random);
    check_mask(have_no_bit_in_common(Eight(sets.data()), Eight(others.data())),
               [&](std::size_t n) { return (bits_of(sets[n]) & bits_of(others[n])) == 0; });
}

// Here each lane keeps its very bits, those of a NaN and of -0 as well.
template <std::size_t width>
void lanes_are_chosen_bit_by_bit(std::mt19937& random) {
    using Eight = FloatLanes<width>;
    const Row p = random_row(random), q = like(p, random), r = random_row(random);
    const Eight a(p.data()), b(q.data()), c(r.data());
    check_lanes(choose(a < b, b, c).each(), is_same, [&](std::size_t n) { return p[n] < q[n] ? q[n] : r[n]; });
    check_lanes(least(a, b).each(), is_same, [&](std::size_t n) { return q[n] < p[n] ? q[n] : p[n]; });
    check_lanes(greatest(a, b).each(), is_same, [&](std::size_t n) { return q[n] > p[n] ? q[n] : p[n]; });
    check_lanes(tagged(a).each(), is_same, [&](std::size_t n) {
        return std::bit_cast<float>((bits_of(p[n]) & ~7u) | static_cast<std::uint32_t>(n));
    });
    for (std::size_t count = 0; count <= kLanes; ++count)
        check_lanes(first_lanes(a, count, b).each(), is_same, [&](std::size_t n) { return n < count ? p[n] : q[n]; });
    check_lanes(Eight(p[3]).each(), is_same_result, [&](std::size_t) { return p[3]; });
}

template <std::size_t width>
void lanes_move_where_they_should(std::mt19937& random) {
    using Eight = FloatLanes<width>;
    const Row p = random_row(random);
    const Eight a(p.data());
    check_lanes(a.rotated().each(), is_same, [&](std::size_t n) { return p[(n + 1) % kLanes]; });
    CHECK(is_same(a.first(), p[0]));
    for (unsigned bits = 0; bits < 256; ++bits) {
        std::array<float, kLanes + 1> room;
        room.fill(77);
        a.pack(bits, room.data());
        std::size_t next = 0;
        for (std::size_t n = 0; n < kLanes; ++n) {
            if (bits >> n & 1) CHECK(is_same(room[next++], p[n]));
        }
        CHECK(is_same(room[kLanes], 77));
    }
}

template <std::size_t width>
void folds_go_from_far_to_near(std::mt19937& random) {
    using Eight = FloatLanes<width>;
    const Row p = random_row(random);
    const auto fold = [&](const auto& rule) {
        return rule(rule(rule(p[0], p[4]), rule(p[2], p[6])), rule(rule(p[1], p[5]), rule(p[3], p[7])));
    };
    const Eight a(p.data());
    CHECK(is_same_result(a.sum(), fold([](float x, float y) { return x + y; })));
    CHECK(is_same(a.least_lane(), fold([](float x, float y) { return y < x ? y : x; })));
    CHECK(is_same(a.greatest_lane(), fold([](float x, float y) { return y > x ? y : x; })));
}

template <std::size_t width>
void lanes_are_single_floats() {
    std::mt19937 random(5);
    for (int trial = 0; trial < 2000; ++trial) {
        arithmetic_is_that_of_single_floats<width>(random);
        comparisons_are_those_of_single_floats<width>(random);
        lanes_are_chosen_bit_by_bit<width>(random);
        lanes_move_where_they_should<width>(random);
        folds_go_from_far_to_near<width>(random);
    }
}

}  // namespace

void test_lanes() {
    lanes_are_single_floats<1>();
#if defined(ISOCORE_VECTOR_TYPES)
    lanes_are_single_floats<4>();
    lanes_are_single_floats<kRegisterLanes>();
#endif
}
