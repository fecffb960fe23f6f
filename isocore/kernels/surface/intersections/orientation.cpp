// orientation.cpp - Determinants as sums of doubles that do not overlap, in which nothing is lost.
// Coordinates must be small enough that products of three differences stay finite, and large enough that those of their
// last digits do not vanish: self_intersections.cpp scales them by a power of two.
#include "surface/intersections/orientation.hpp"

#include <array>

namespace isocore::intersections {
namespace {

// Two doubles, the second of them the rounding error of the first.
struct Pair {
    double high, low;
};

Pair sum_of(double a, double b) {
    const double high = a + b, virtual_b = high - a, virtual_a = high - virtual_b;
    return {high, (a - virtual_a) + (b - virtual_b)};
}

Pair product_of(double a, double b) {
    const double high = a * b;
    return {high, std::fma(a, b, -high)};
}

Pair difference_of(double a, double b) { return sum_of(a, -b); }

// A sum of at most `kMost` doubles, from the smallest to the largest, none of which overlaps another.
class Expansion {
  public:
    static constexpr std::size_t kMost = 192;

    void add(double value) {
        std::size_t kept = 0;
        for (std::size_t n = 0; n < size_; ++n) {
            const Pair sum = sum_of(value, terms_[n]);
            value = sum.high;
            if (sum.low != 0) terms_[kept++] = sum.low;
        }
        if (value != 0) terms_[kept++] = value;
        size_ = kept;
    }

    // Adds the product of a double and what another expansion stands for.
    void add_product(double factor, const Expansion& other) {
        for (std::size_t n = 0; n < other.size_; ++n) {
            const Pair product = product_of(factor, other.terms_[n]);
            add(product.low);
            add(product.high);
        }
    }

    // Adds sign * a * b.
    void add_product(const Pair& a, const Pair& b, double sign) {
        for (const double x : {a.low, a.high}) {
            for (const double y : {b.low, b.high}) {
                if (x == 0 || y == 0) continue;
                const Pair product = product_of(sign * x, y);
                add(product.low);
                add(product.high);
            }
        }
    }

    // The largest term has the sign of all.
    int sign() const { return size_ == 0 ? 0 : sign_of(terms_[size_ - 1]); }

  private:
    std::array<double, kMost> terms_;
    std::size_t size_ = 0;
};

}  // namespace

int exact_plane_side(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    std::array<std::array<Pair, 3>, 3> rows;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        rows[0][axis] = difference_of(a[axis], d[axis]);
        rows[1][axis] = difference_of(b[axis], d[axis]);
        rows[2][axis] = difference_of(c[axis], d[axis]);
    }
    Expansion determinant;
    for (std::size_t n = 0; n < 3; ++n) {
        const auto &next = rows[(n + 1) % 3], &last = rows[(n + 2) % 3];
        Expansion minor;
        minor.add_product(next[1], last[2], 1);
        minor.add_product(next[2], last[1], -1);
        if (rows[n][0].low != 0) determinant.add_product(rows[n][0].low, minor);
        determinant.add_product(rows[n][0].high, minor);
    }
    return determinant.sign();
}

int exact_line_side(double ax, double ay, double bx, double by, double cx, double cy) {
    Expansion determinant;
    determinant.add_product(difference_of(ax, cx), difference_of(by, cy), 1);
    determinant.add_product(difference_of(ay, cy), difference_of(bx, cx), -1);
    return determinant.sign();
}

}  // namespace isocore::intersections
