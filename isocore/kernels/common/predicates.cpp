// predicates.cpp - Follows J. R. Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric
// Predicates", Discrete & Computational Geometry 18, 1997: an error bound for the common case (section 4), and exact
// sums of doubles for the rest (section 2). Between them come integers: the flat places of a surface, where only exact
// arithmetic can tell, have coordinates of few bits, half voxels or float32. Nothing here may be contracted to fused
// operations.
#include "common/predicates.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace isocore {
namespace {

// Two doubles whose exact sum is the result of an operation: what a double holds of it, and the rest.
struct Pair {
    double high, low;
};

Pair exact_sum(double a, double b) {
    const double sum = a + b, of_b = sum - a, of_a = sum - of_b;
    return {sum, (a - of_a) + (b - of_b)};
}

Pair exact_product(double a, double b) {
    constexpr double kSplitter = 134217729;  // 2^27 + 1
    const auto split = [](double x) {
        const double big = kSplitter * x, high = big - (big - x);
        return Pair{high, x - high};
    };
    const double product = a * b;
    const Pair x = split(a), y = split(b);
    const double rest = ((x.high * y.high - product) + x.high * y.low + x.low * y.high) + x.low * y.low;
    return {product, rest};
}

// An exact sum, kept as doubles that do not overlap, the smallest first.
class ExactSum {
  public:
    void add(double number) {
        std::size_t kept = 0;
        for (std::size_t n = 0; n < size_; ++n) {
            const Pair sum = exact_sum(number, terms_[n]);
            if (sum.low != 0) terms_[kept++] = sum.low;
            number = sum.high;
        }
        if (number != 0) terms_[kept++] = number;
        size_ = kept;
    }
    void add_product(double a, double b) {
        if (a == 0 || b == 0) return;
        const Pair product = exact_product(a, b);
        add(product.low);
        add(product.high);
    }
    void add_product(double a, double b, double c) {
        if (a == 0 || b == 0 || c == 0) return;
        const Pair product = exact_product(a, b);
        add_product(product.low, c);
        add_product(product.high, c);
    }
    int sign() const { return size_ == 0 ? 0 : terms_[size_ - 1] > 0 ? 1 : -1; }

  private:
    static constexpr std::size_t kMost = 192;  // 6 products of 3 pairs, each of which is 4 doubles
    std::array<double, kMost> terms_;
    std::size_t size_ = 0;
};

using Parts = std::array<double, 2>;  // of an exact difference
using Parts3 = std::array<Parts, 3>;

Parts3 exact_difference(const Point& a, const Point& b) {
    Parts3 out;
    for (std::size_t n = 0; n < 3; ++n) {
        const Pair sum = exact_sum(a[n], -b[n]);
        out[n] = {sum.high, sum.low};
    }
    return out;
}

// Differences of coordinates as integers below 2^30, all multiplied by the same power of two: if all are exact, and
// none has too many bits.
template <std::size_t count>
class Integers {
  public:
    void add(double one, double other) {
        const Pair sum = exact_sum(one, -other);
        are_exact_ = are_exact_ && sum.low == 0;
        largest_ = std::max(largest_, std::abs(sum.high));
        differences_[size_++] = sum.high;
    }

    std::optional<std::array<std::int64_t, count>> take() const {
        constexpr std::uint64_t kBits = 30, kBias = 1023, kMantissa = 52;
        const std::uint64_t exponent = std::bit_cast<std::uint64_t>(largest_) >> kMantissa;
        if (!are_exact_ || exponent < kBits || exponent > 2 * kBias) return std::nullopt;
        const double scale = std::bit_cast<double>((2 * kBias + kBits - 1 - exponent) << kMantissa);
        std::array<std::int64_t, count> out;
        bool are_whole = true;
        for (std::size_t n = 0; n < count; ++n) {
            const double scaled = differences_[n] * scale;
            out[n] = static_cast<std::int64_t>(scaled);
            are_whole = are_whole && static_cast<double>(out[n]) == scaled;
        }
        return are_whole ? std::optional(out) : std::nullopt;
    }

  private:
    std::array<double, count> differences_;
    std::size_t size_ = 0;
    double largest_ = 0;
    bool are_exact_ = true;
};

int sign_of(std::int64_t number) { return number > 0 ? 1 : number < 0 ? -1 : 0; }

// The sign of a determinant whose numbers are below 2^30: its minors are below 2^61, and their products with the last
// row are summed in two halves.
int sign_of_determinant(const std::array<std::int64_t, 9>& m) {
    constexpr int kHalf = 30;
    constexpr std::int64_t kLow = (std::int64_t{1} << kHalf) - 1;
    std::int64_t high = 0, low = 0;
    for (std::size_t x = 0; x < 3; ++x) {
        const std::size_t y = (x + 1) % 3, z = (x + 2) % 3;
        const std::int64_t minor = m[y] * m[3 + z] - m[z] * m[3 + y];
        high += m[6 + x] * (minor >> kHalf);
        low += m[6 + x] * (minor & kLow);
    }
    high += low >> kHalf;
    return high != 0 ? sign_of(high) : sign_of(low & kLow);
}

int exact_side(const Point& a, const Point& b, const Point& c, const Point& d) {
    Integers<9> differences;
    for (const Point* const point : {&b, &c, &d}) {
        for (std::size_t n = 0; n < 3; ++n) differences.add((*point)[n], a[n]);
    }
    if (const auto integers = differences.take()) return sign_of_determinant(*integers);
    const std::array<Parts3, 3> rows{exact_difference(b, a), exact_difference(c, a), exact_difference(d, a)};
    ExactSum sum;
    for (std::size_t x = 0; x < 3; ++x) {
        for (std::size_t n = 1; n < 3; ++n) {  // the even and the odd permutation that begin with x
            const std::size_t y = (x + n) % 3, z = (x + 3 - n) % 3;
            for (const double p : rows[0][x]) {
                for (const double q : rows[1][y]) {
                    for (const double r : rows[2][z]) sum.add_product(n == 1 ? p : -p, q, r);
                }
            }
        }
    }
    return sum.sign();
}

}  // namespace

int side_of_plane(const Point& a, const Point& b, const Point& c, const Point& d) {
    const double bx = b[0] - a[0], by = b[1] - a[1], bz = b[2] - a[2];
    const double cx = c[0] - a[0], cy = c[1] - a[1], cz = c[2] - a[2];
    const double dx = d[0] - a[0], dy = d[1] - a[1], dz = d[2] - a[2];
    const double yz = by * cz, zy = bz * cy, zx = bz * cx, xz = bx * cz, xy = bx * cy, yx = by * cx;
    const double determinant = dx * (yz - zy) + dy * (zx - xz) + dz * (xy - yx);
    const double size = std::abs(dx) * (std::abs(yz) + std::abs(zy)) + std::abs(dy) * (std::abs(zx) + std::abs(xz)) +
                        std::abs(dz) * (std::abs(xy) + std::abs(yx));
    constexpr double kRounding = 8e-16;  // of `size`: more than (7 + 56 * 2^-53) * 2^-53, section 4.3
    if (determinant > kRounding * size) return 1;
    if (determinant < -kRounding * size) return -1;
    if (size == 0) return 0;
    return exact_side(a, b, c, d);
}

int turn(const Point& a, const Point& b, const Point& c, std::size_t axis) {
    const std::size_t x = (axis + 1) % 3, y = (axis + 2) % 3;
    const double left = (b[x] - a[x]) * (c[y] - a[y]), right = (b[y] - a[y]) * (c[x] - a[x]);
    constexpr double kRounding = 4e-16;  // more than (3 + 16 * 2^-53) * 2^-53
    const double size = kRounding * (std::abs(left) + std::abs(right));
    if (left - right > size) return 1;
    if (left - right < -size) return -1;
    if (size == 0) return 0;
    Integers<4> differences;
    for (const Point* const point : {&b, &c}) {
        for (const std::size_t n : {x, y}) differences.add((*point)[n], a[n]);
    }
    if (const auto to = differences.take()) return sign_of((*to)[0] * (*to)[3] - (*to)[1] * (*to)[2]);
    const Parts3 to_b = exact_difference(b, a), to_c = exact_difference(c, a);
    ExactSum sum;
    for (const double p : to_b[x]) {
        for (const double q : to_c[y]) sum.add_product(p, q);
    }
    for (const double p : to_b[y]) {
        for (const double q : to_c[x]) sum.add_product(-p, q);
    }
    return sum.sign();
}

}  // namespace isocore
