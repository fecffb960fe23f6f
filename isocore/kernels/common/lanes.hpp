// lanes.hpp - Eight floats at once. Every operation is that of its floats one by one and never fused with another, so
// results are the same bits with every compiler and on every processor. Only which of the many NaNs an operation yields
// is up to them.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>

#if defined(__AVX2__)
#include <immintrin.h>
#elif defined(__SSE2__)
#include <emmintrin.h>
#endif

#if defined(__has_builtin)
#if __has_builtin(__builtin_shufflevector)
#define ISOCORE_VECTOR_TYPES
#endif
#endif

namespace isocore {

inline constexpr std::size_t kLanes = 8;

// The lanes of one register; a single one where the compiler has no vector types (MSVC, GCC before 12). A vector type
// of eight lanes would do everywhere, but where registers are narrower, GCC compares its lanes one after the other.
#if !defined(ISOCORE_VECTOR_TYPES)
inline constexpr std::size_t kRegisterLanes = 1;
#elif defined(__AVX2__)
inline constexpr std::size_t kRegisterLanes = 8;
#else
inline constexpr std::size_t kRegisterLanes = 4;
#endif

// The types of a register, and what there is no operator for. Comparisons of `Reals` yield `Ints` that are 0 in the
// lanes where they do not hold.
template <std::size_t width>
struct Register;

template <>
struct Register<1> {
    using Reals = float;
    using Ints = std::int32_t;
    static Reals moved_up(Reals, Reals next) { return next; }
    static Reals roots(Reals a) { return std::sqrt(a); }
    static unsigned bits(Ints mask) { return mask != 0; }
};

#if defined(ISOCORE_VECTOR_TYPES)
template <std::size_t width>
struct VectorTypes {  // apart from Register, as GCC cannot index them in the template that declares them
    typedef float Reals __attribute__((vector_size(4 * width)));
    typedef std::int32_t Ints __attribute__((vector_size(4 * width)));
};

template <std::size_t width>
struct Register {
    using Reals = typename VectorTypes<width>::Reals;
    using Ints = typename VectorTypes<width>::Ints;
    using Places = std::make_index_sequence<width>;

    // The lanes of `a` after its first, then the first lane of `next`.
    static Reals moved_up(Reals a, Reals next) {
        return [&]<std::size_t... n>(std::index_sequence<n...>) {
            return __builtin_shufflevector(a, next, (n + 1)...);
        }(Places());
    }
    // Lanes that are `distance` apart, a power of two, change places.
    template <std::size_t distance>
    static Reals swapped(Reals a) {
        return [&]<std::size_t... n>(std::index_sequence<n...>) {
            return __builtin_shufflevector(a, a, (n ^ distance)...);
        }(Places());
    }
    // Compilers make a single instruction of this loop.
    static Reals roots(Reals a) {
        for (std::size_t n = 0; n < width; ++n) a[n] = std::sqrt(a[n]);
        return a;
    }
    // One bit a lane: does the comparison hold there?
    static unsigned bits(Ints mask) {
#if defined(__AVX2__)
        if constexpr (width == 8) return static_cast<unsigned>(_mm256_movemask_ps(reinterpret_cast<__m256>(mask)));
#endif
#if defined(__SSE2__)
        if constexpr (width == 4) return static_cast<unsigned>(_mm_movemask_ps(reinterpret_cast<__m128>(mask)));
#endif
        unsigned out = 0;
        for (std::size_t n = 0; n < width; ++n) out |= static_cast<unsigned>(mask[n]) & 1u << n;
        return out;
    }
};
#endif

// rule(n) of each register that eight lanes take.
template <class Type, class Rule>
std::array<Type, kLanes * sizeof(float) / sizeof(Type)> each_register(const Rule& rule) {
    std::array<Type, kLanes * sizeof(float) / sizeof(Type)> out;
    for (std::size_t n = 0; n < out.size(); ++n) out[n] = static_cast<Type>(rule(n));
    return out;
}

// In which lanes a comparison holds.
template <std::size_t width>
struct LaneMask {
    using Ints = typename Register<width>::Ints;
    std::array<Ints, kLanes / width> registers;

    friend LaneMask operator&(const LaneMask& a, const LaneMask& b) {
        return {each_register<Ints>([&](std::size_t n) { return a.registers[n] & b.registers[n]; })};
    }
    friend LaneMask operator|(const LaneMask& a, const LaneMask& b) {
        return {each_register<Ints>([&](std::size_t n) { return a.registers[n] | b.registers[n]; })};
    }
    bool any() const { return bits() != 0; }
    // The first lane's bit is the lowest.
    unsigned bits() const {
        unsigned out = 0;
        for (std::size_t n = 0; n < registers.size(); ++n) out |= Register<width>::bits(registers[n]) << n * width;
        return out;
    }
};

#if defined(__AVX2__)
// For each mask: the numbers of the lanes whose bits are set, in order, then zeros.
inline constexpr auto kPackedLanes = [] {
    std::array<std::array<std::int32_t, kLanes>, 256> order{};
    for (unsigned bits = 0; bits < order.size(); ++bits) {
        std::size_t next = 0;
        for (std::int32_t lane = 0; lane < 8; ++lane) {
            if (bits >> lane & 1) order[bits][next++] = lane;
        }
    }
    return order;
}();
#endif

// Eight floats in registers of `width` lanes.
template <std::size_t width>
class FloatLanes {
  public:
    using Mask = LaneMask<width>;

    FloatLanes() = default;
    FloatLanes(float value) {
        for (Reals& some : registers_) some = value - Reals{};  // to all lanes; less 0 keeps every value, -0 as well
    }
    explicit FloatLanes(const float* from) { std::memcpy(&registers_, from, sizeof registers_); }
    void store(float* to) const { std::memcpy(to, &registers_, sizeof registers_); }
    std::array<float, kLanes> each() const { return std::bit_cast<std::array<float, kLanes>>(registers_); }
    float first() const { return each()[0]; }
    // Writes the lanes whose bits are set, one after the other. It may write as many floats as there are lanes: what
    // follows in `to` is lost.
    void pack(unsigned bits, float* to) const {
#if defined(__AVX2__)
        if constexpr (width == kLanes) {
            const auto order = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(kPackedLanes[bits].data()));
            return _mm256_storeu_ps(to, _mm256_permutevar8x32_ps(registers_[0], order));
        }
#endif
        for (const float lane : each()) {
            *to = lane;
            to += bits & 1;
            bits >>= 1;
        }
    }

    friend FloatLanes operator+(const FloatLanes& a, const FloatLanes& b) {
        return by([&](std::size_t n) { return a.registers_[n] + b.registers_[n]; });
    }
    friend FloatLanes operator-(const FloatLanes& a, const FloatLanes& b) {
        return by([&](std::size_t n) { return a.registers_[n] - b.registers_[n]; });
    }
    friend FloatLanes operator*(const FloatLanes& a, const FloatLanes& b) {
        return by([&](std::size_t n) { return a.registers_[n] * b.registers_[n]; });
    }
    friend FloatLanes operator/(const FloatLanes& a, const FloatLanes& b) {
        return by([&](std::size_t n) { return a.registers_[n] / b.registers_[n]; });
    }
    friend FloatLanes root(const FloatLanes& a) {
        return by([&](std::size_t n) { return Register<width>::roots(a.registers_[n]); });
    }
    friend Mask operator<(const FloatLanes& a, const FloatLanes& b) {
        return where([&](std::size_t n) { return a.registers_[n] < b.registers_[n]; });
    }
    friend Mask operator<=(const FloatLanes& a, const FloatLanes& b) {
        return where([&](std::size_t n) { return a.registers_[n] <= b.registers_[n]; });
    }
    friend Mask operator==(const FloatLanes& a, const FloatLanes& b) {
        return where([&](std::size_t n) { return a.registers_[n] == b.registers_[n]; });
    }
    // Where no bit is set in both a and b: lanes may be used as sets of up to 32.
    friend Mask have_no_bit_in_common(const FloatLanes& a, const FloatLanes& b) {
        return where([&](std::size_t n) { return (a.ints(n) & b.ints(n)) == 0; });
    }

    // Where all bits are the same: lanes may be used as whole numbers.
    friend Mask have_same_bits(const FloatLanes& a, const FloatLanes& b) {
        return where([&](std::size_t n) { return a.ints(n) == b.ints(n); });
    }

    friend FloatLanes choose(const Mask& mask, const FloatLanes& a, const FloatLanes& b) {
        return by([&](std::size_t n) { return mask.registers[n] ? a.registers_[n] : b.registers_[n]; });
    }
    // b where it is less than a, otherwise a. So NaN in b yields a, NaN in a stays NaN, and of 0 and -0 it is a.
    friend FloatLanes least(const FloatLanes& a, const FloatLanes& b) {
        return by([&](std::size_t n) { return b.registers_[n] < a.registers_[n] ? b.registers_[n] : a.registers_[n]; });
    }
    // b where it is greater than a, otherwise a: with NaN and zeros as `least`.
    friend FloatLanes greatest(const FloatLanes& a, const FloatLanes& b) {
        return by([&](std::size_t n) { return b.registers_[n] > a.registers_[n] ? b.registers_[n] : a.registers_[n]; });
    }
    // The first `count` lanes of a, and the others of b.
    friend FloatLanes first_lanes(const FloatLanes& a, std::size_t count, const FloatLanes& b) {
        static constexpr std::array<float, kLanes> kNumbers{0, 1, 2, 3, 4, 5, 6, 7};
        return choose(FloatLanes(kNumbers.data()) < static_cast<float>(count), a, b);
    }
    // The lanes with their numbers, 0 to 7, in place of their last three bits: so the least lane tells which it was.
    friend FloatLanes tagged(const FloatLanes& a) {
        static constexpr std::array<std::int32_t, kLanes> kNumbers{0, 1, 2, 3, 4, 5, 6, 7};
        const auto numbers = std::bit_cast<std::array<Ints, kLanes / width>>(kNumbers);
        return by([&](std::size_t n) { return std::bit_cast<Reals>((a.ints(n) & ~7) | numbers[n]); });
    }

    // Lanes 1 to 7, then lane 0.
    FloatLanes rotated() const {
        return by([&](std::size_t n) {
            return Register<width>::moved_up(registers_[n], registers_[(n + 1) % registers_.size()]);
        });
    }
    // Sums depend on their order: ((0 + 4) + (2 + 6)) + ((1 + 5) + (3 + 7)), lanes by number. So do least and greatest,
    // where there are NaNs.
    float sum() const {
        return fold<4>(*this, [](const FloatLanes& a, const FloatLanes& b) { return a + b; });
    }
    float least_lane() const {
        return fold<4>(*this, [](const FloatLanes& a, const FloatLanes& b) { return least(a, b); });
    }
    float greatest_lane() const {
        return fold<4>(*this, [](const FloatLanes& a, const FloatLanes& b) { return greatest(a, b); });
    }

  private:
    using Reals = typename Register<width>::Reals;
    using Ints = typename Register<width>::Ints;

    template <class Rule>
    static FloatLanes by(const Rule& rule) {
        FloatLanes out;
        out.registers_ = each_register<Reals>(rule);
        return out;
    }
    template <class Rule>
    static Mask where(const Rule& rule) {
        return {each_register<Ints>(rule)};
    }
    Ints ints(std::size_t n) const { return std::bit_cast<Ints>(registers_[n]); }

    template <std::size_t distance>
    FloatLanes swapped() const {
        return by([&](std::size_t n) {
            if constexpr (distance < width)
                return Register<width>::template swapped<distance>(registers_[n]);
            else
                return registers_[n ^ distance / width];
        });
    }
    template <std::size_t distance, class Rule>
    static float fold(const FloatLanes& a, const Rule& rule) {
        if constexpr (distance == 0)
            return a.first();
        else
            return fold<distance / 2>(rule(a, a.template swapped<distance>()), rule);
    }

    std::array<Reals, kLanes / width> registers_;
};

using Floats = FloatLanes<kRegisterLanes>;

}  // namespace isocore
