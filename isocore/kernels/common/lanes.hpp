// lanes.hpp - Eight floats or four doubles at once. Every operation is that of its numbers one by one, so results are
// the same bits with and without wide registers.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#if defined(__AVX2__)
#include <immintrin.h>
#endif

namespace isocore {

template <class T>
inline constexpr std::size_t kLanes = 32 / sizeof(T);

template <class T>
inline constexpr auto kLaneNumbers = [] {
    std::array<T, kLanes<T>> numbers;
    for (std::size_t n = 0; n < numbers.size(); ++n) numbers[n] = static_cast<T>(n);
    return numbers;
}();

#if defined(__AVX2__)

// By the lanes of a mask, one bit each: their numbers, first of all.
inline constexpr auto kPackedLanes = [] {
    std::array<std::array<std::int32_t, 8>, 256> order{};
    for (unsigned mask = 0; mask < 256; ++mask) {
        std::size_t next = 0;
        for (std::int32_t lane = 0; lane < 8; ++lane) {
            if (mask >> lane & 1) order[mask][next++] = lane;
        }
    }
    return order;
}();

template <class T>
struct LaneRegister;
template <>
struct LaneRegister<float> {
    using Type = __m256;
    static Type load(const float* from) { return _mm256_loadu_ps(from); }
    static Type all(float value) { return _mm256_set1_ps(value); }
    static void store(float* to, Type a) { _mm256_storeu_ps(to, a); }
    static Type add(Type a, Type b) { return _mm256_add_ps(a, b); }
    static Type subtract(Type a, Type b) { return _mm256_sub_ps(a, b); }
    static Type multiply(Type a, Type b) { return _mm256_mul_ps(a, b); }
    static Type divide(Type a, Type b) { return _mm256_div_ps(a, b); }
    static Type root(Type a) { return _mm256_sqrt_ps(a); }
    static Type least(Type a, Type b) { return _mm256_min_ps(b, a); }
    static Type greatest(Type a, Type b) { return _mm256_max_ps(b, a); }
    static Type less(Type a, Type b) { return _mm256_cmp_ps(a, b, _CMP_LT_OQ); }
    static Type not_above(Type a, Type b) { return _mm256_cmp_ps(a, b, _CMP_LE_OQ); }
    static Type equal(Type a, Type b) { return _mm256_cmp_ps(a, b, _CMP_EQ_OQ); }
    static Type both(Type a, Type b) { return _mm256_and_ps(a, b); }
    static Type either(Type a, Type b) { return _mm256_or_ps(a, b); }
    static Type disjoint(Type a, Type b) {
        return _mm256_castsi256_ps(
            _mm256_cmpeq_epi32(_mm256_castps_si256(_mm256_and_ps(a, b)), _mm256_setzero_si256()));
    }
    static Type tagged(Type a) {
        const Type lanes = _mm256_castsi256_ps(_mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7));
        return _mm256_or_ps(_mm256_and_ps(a, _mm256_castsi256_ps(_mm256_set1_epi32(~7))), lanes);
    }
    static Type choose(Type mask, Type a, Type b) { return _mm256_blendv_ps(b, a, mask); }
    static bool any(Type mask) { return _mm256_movemask_ps(mask) != 0; }
    static unsigned bits(Type mask) { return static_cast<unsigned>(_mm256_movemask_ps(mask)); }
    static float first(Type a) { return _mm256_cvtss_f32(a); }
    static Type rotate(Type a) { return _mm256_permutevar8x32_ps(a, _mm256_setr_epi32(1, 2, 3, 4, 5, 6, 7, 0)); }
    template <std::size_t distance>
    static Type swap(Type a) {
        if constexpr (distance == 4)
            return _mm256_permute2f128_ps(a, a, 1);
        else
            return _mm256_permute_ps(a, distance == 2 ? 0x4e : 0xb1);
    }
    static void pack(Type a, unsigned bits, float* to) {
        const auto order = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(kPackedLanes[bits].data()));
        _mm256_storeu_ps(to, _mm256_permutevar8x32_ps(a, order));
    }
};
template <>
struct LaneRegister<double> {
    using Type = __m256d;
    static Type load(const double* from) { return _mm256_loadu_pd(from); }
    static Type all(double value) { return _mm256_set1_pd(value); }
    static void store(double* to, Type a) { _mm256_storeu_pd(to, a); }
    static Type add(Type a, Type b) { return _mm256_add_pd(a, b); }
    static Type subtract(Type a, Type b) { return _mm256_sub_pd(a, b); }
    static Type multiply(Type a, Type b) { return _mm256_mul_pd(a, b); }
    static Type divide(Type a, Type b) { return _mm256_div_pd(a, b); }
    static Type root(Type a) { return _mm256_sqrt_pd(a); }
    static Type least(Type a, Type b) { return _mm256_min_pd(b, a); }
    static Type greatest(Type a, Type b) { return _mm256_max_pd(b, a); }
    static Type less(Type a, Type b) { return _mm256_cmp_pd(a, b, _CMP_LT_OQ); }
    static Type not_above(Type a, Type b) { return _mm256_cmp_pd(a, b, _CMP_LE_OQ); }
    static Type equal(Type a, Type b) { return _mm256_cmp_pd(a, b, _CMP_EQ_OQ); }
    static Type both(Type a, Type b) { return _mm256_and_pd(a, b); }
    static Type either(Type a, Type b) { return _mm256_or_pd(a, b); }
    static Type choose(Type mask, Type a, Type b) { return _mm256_blendv_pd(b, a, mask); }
    static bool any(Type mask) { return _mm256_movemask_pd(mask) != 0; }
};

#else

// A mask is 1 in its true lanes and 0 in the others.
template <class T>
struct LaneRegister {
    using Type = std::array<T, kLanes<T>>;
    template <class Rule>
    static Type each(const Rule& rule) {
        Type out;
        for (std::size_t n = 0; n < kLanes<T>; ++n) out[n] = rule(n);
        return out;
    }
    static Type load(const T* from) {
        return each([&](std::size_t n) { return from[n]; });
    }
    static Type all(T value) {
        return each([&](std::size_t) { return value; });
    }
    static void store(T* to, const Type& a) {
        each([&](std::size_t n) { return to[n] = a[n]; });
    }
    static Type add(const Type& a, const Type& b) {
        return each([&](std::size_t n) { return a[n] + b[n]; });
    }
    static Type subtract(const Type& a, const Type& b) {
        return each([&](std::size_t n) { return a[n] - b[n]; });
    }
    static Type multiply(const Type& a, const Type& b) {
        return each([&](std::size_t n) { return a[n] * b[n]; });
    }
    static Type divide(const Type& a, const Type& b) {
        return each([&](std::size_t n) { return a[n] / b[n]; });
    }
    static Type root(const Type& a) {
        return each([&](std::size_t n) { return std::sqrt(a[n]); });
    }
    static Type least(const Type& a, const Type& b) {
        return each([&](std::size_t n) { return b[n] < a[n] ? b[n] : a[n]; });
    }
    static Type greatest(const Type& a, const Type& b) {
        return each([&](std::size_t n) { return b[n] > a[n] ? b[n] : a[n]; });
    }
    static Type less(const Type& a, const Type& b) {
        return each([&](std::size_t n) { return T(a[n] < b[n]); });
    }
    static Type not_above(const Type& a, const Type& b) {
        return each([&](std::size_t n) { return T(a[n] <= b[n]); });
    }
    static Type equal(const Type& a, const Type& b) {
        return each([&](std::size_t n) { return T(a[n] == b[n]); });
    }
    static Type disjoint(const Type& a, const Type& b) {
        return each([&](std::size_t n) {
            return T((std::bit_cast<std::uint32_t>(a[n]) & std::bit_cast<std::uint32_t>(b[n])) == 0);
        });
    }
    static Type tagged(const Type& a) {
        return each([&](std::size_t n) {
            return std::bit_cast<float>((std::bit_cast<std::uint32_t>(a[n]) & ~7u) | static_cast<std::uint32_t>(n));
        });
    }
    static Type both(const Type& a, const Type& b) {
        return each([&](std::size_t n) { return a[n] * b[n]; });
    }
    static Type either(const Type& a, const Type& b) {
        return each([&](std::size_t n) { return T(a[n] + b[n] > 0); });
    }
    static Type choose(const Type& mask, const Type& a, const Type& b) {
        return each([&](std::size_t n) { return mask[n] != 0 ? a[n] : b[n]; });
    }
    static bool any(const Type& mask) { return bits(mask) != 0; }
    static T first(const Type& a) { return a[0]; }
    static Type rotate(const Type& a) {
        return each([&](std::size_t n) { return a[(n + 1) % kLanes<T>]; });
    }
    template <std::size_t distance>
    static Type swap(const Type& a) {
        return each([&](std::size_t n) { return a[n ^ distance]; });
    }
    static unsigned bits(const Type& mask) {
        unsigned out = 0;
        for (std::size_t n = 0; n < kLanes<T>; ++n) out |= static_cast<unsigned>(mask[n] != 0) << n;
        return out;
    }
    static void pack(const Type& a, unsigned bits, T* to) {
        for (std::size_t n = 0; n < kLanes<T>; ++n) {
            *to = a[n];
            to += bits >> n & 1;
        }
    }
};

#endif

// The result of a comparison of Lanes.
template <class T>
struct LaneMask {
    using Register = LaneRegister<T>;
    typename Register::Type lanes;
    friend LaneMask operator&(const LaneMask& a, const LaneMask& b) { return {Register::both(a.lanes, b.lanes)}; }
    friend LaneMask operator|(const LaneMask& a, const LaneMask& b) { return {Register::either(a.lanes, b.lanes)}; }
    bool any() const { return Register::any(lanes); }
    unsigned bits() const { return Register::bits(lanes); }
};

template <class T>
struct Lanes {
    using Register = LaneRegister<T>;
    typename Register::Type lanes;

    Lanes() = default;
    Lanes(T value) : lanes(Register::all(value)) {}
    explicit Lanes(typename Register::Type given) : lanes(given) {}
    explicit Lanes(const T* from) : lanes(Register::load(from)) {}
    void store(T* to) const { Register::store(to, lanes); }
    std::array<T, kLanes<T>> each() const {
        std::array<T, kLanes<T>> out;
        Register::store(out.data(), lanes);
        return out;
    }

    T first() const { return Register::first(lanes); }
    // Each lane where the one before was, and the first one last.
    Lanes rotated() const { return Lanes(Register::rotate(lanes)); }

    // The rule over all lanes: first of those that are half of all apart, at last of neighbours.
    template <class Rule>
    T fold(const Rule& rule) const {
        return folded<kLanes<T> / 2>(*this, rule);
    }
    T sum() const {
        return fold([](const Lanes& a, const Lanes& b) { return a + b; });
    }
    T least_lane() const {
        return fold([](const Lanes& a, const Lanes& b) { return least(a, b); });
    }
    T greatest_lane() const {
        return fold([](const Lanes& a, const Lanes& b) { return greatest(a, b); });
    }

    // Writes the lanes that have a bit, one after the other; what follows them in the room for all lanes is lost.
    void pack(unsigned bits, T* to) const { Register::pack(lanes, bits, to); }

    friend Lanes operator+(const Lanes& a, const Lanes& b) { return Lanes(Register::add(a.lanes, b.lanes)); }
    friend Lanes operator-(const Lanes& a, const Lanes& b) { return Lanes(Register::subtract(a.lanes, b.lanes)); }
    friend Lanes operator*(const Lanes& a, const Lanes& b) { return Lanes(Register::multiply(a.lanes, b.lanes)); }
    friend Lanes operator/(const Lanes& a, const Lanes& b) { return Lanes(Register::divide(a.lanes, b.lanes)); }
    friend Lanes root(const Lanes& a) { return Lanes(Register::root(a.lanes)); }
    friend LaneMask<T> operator<(const Lanes& a, const Lanes& b) { return {Register::less(a.lanes, b.lanes)}; }
    friend LaneMask<T> operator<=(const Lanes& a, const Lanes& b) { return {Register::not_above(a.lanes, b.lanes)}; }
    friend LaneMask<T> operator==(const Lanes& a, const Lanes& b) { return {Register::equal(a.lanes, b.lanes)}; }
    // Of floats: have their bits none in common?
    friend LaneMask<T> have_no_bit_in_common(const Lanes& a, const Lanes& b) {
        return {Register::disjoint(a.lanes, b.lanes)};
    }
    // Floats with their lane in the last three bits: the least one tells where it is.
    friend Lanes tagged(const Lanes& a) { return Lanes(Register::tagged(a.lanes)); }
    // The first `count` lanes of a, and the others of b.
    friend Lanes first_lanes(const Lanes& a, std::size_t count, const Lanes& b) {
        return choose(Lanes(kLaneNumbers<T>.data()) < static_cast<T>(count), a, b);
    }
    friend Lanes choose(const LaneMask<T>& mask, const Lanes& a, const Lanes& b) {
        return Lanes(Register::choose(mask.lanes, a.lanes, b.lanes));
    }
    // Lanes of b that are no numbers are passed over.
    friend Lanes least(const Lanes& a, const Lanes& b) { return Lanes(Register::least(a.lanes, b.lanes)); }
    friend Lanes greatest(const Lanes& a, const Lanes& b) { return Lanes(Register::greatest(a.lanes, b.lanes)); }

  private:
    template <std::size_t distance, class Rule>
    static T folded(const Lanes& a, const Rule& rule) {
        if constexpr (distance == 0)
            return Register::first(a.lanes);
        else
            return folded<distance / 2>(rule(a, Lanes(Register::template swap<distance>(a.lanes))), rule);
    }
};

}  // namespace isocore
