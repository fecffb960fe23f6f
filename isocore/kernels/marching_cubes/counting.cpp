// counting.cpp - The counting pass of W. Schroeder, R. Maynard, B. Geveci, "Flying Edges: A High-Performance Scalable
// Isocontouring Algorithm", LDAV 2015, on sign bits: every sum is a popcount.
#include "marching_cubes/counting.hpp"

#include <array>
#include <cstdint>
#include <limits>
#include <stdexcept>

#include "common/parallel.hpp"
#include "marching_cubes/cell_rows.hpp"

namespace isocore::marching_cubes {
namespace {

class Counter {
  public:
    Counter(const SignGrid& signs, std::vector<RowBase>& bases, bool tubes)
        : signs_(signs), bases_(bases), tubes_(tubes) {}

    // Fills the bases of plane k with counts (number() turns them into numbers) and returns its sums.
    LayerCount count(std::size_t k) const {
        const std::size_t rows = signs_.dims[1];
        const bool has_cells = k + 1 < signs_.dims[2];
        LayerCount sum;
        for (std::size_t j = 0; j < rows; ++j) {
            const RowBase counts = count_crossings(signs_, j, k);
            bases_[j + rows * k] = counts;
            sum.vertices += std::size_t{counts[0]} + counts[1] + counts[2];
            if (has_cells && j + 1 < rows) sum.triangles += triangles_at_most(j, k);
        }
        return sum;
    }

  private:
    std::size_t triangles_at_most(std::size_t j, std::size_t k) const {
        const CellRow rows(signs_, j, k);
        std::size_t crossed = 0, active = 0;
        for (std::size_t w = 0; w < signs_.words; ++w) {
            const Word valid = signs_.valid(w, 1);
            const Word cells = rows.active(w, valid);
            if (cells == 0) continue;
            active += ones(cells);
            for (int n = 0; n < 4; ++n) crossed += ones((rows.here(n, w) ^ rows.next(n, w)) & valid);
            for (const auto [a, b] : kAcross) {
                crossed += ones((rows.here(a, w) ^ rows.here(b, w)) & valid) +
                           ones((rows.next(a, w) ^ rows.next(b, w)) & valid);
            }
        }
        return tubes_ ? crossed : crossed - 2 * active;
    }

    // Pairs of a cell row's sample rows that edges along y and z join.
    static constexpr std::array<std::array<int, 2>, 4> kAcross{{{0, 1}, {2, 3}, {0, 2}, {1, 3}}};
    const SignGrid& signs_;
    std::vector<RowBase>& bases_;
    bool tubes_;
};

}  // namespace

std::vector<LayerCount> count_layers(const SignGrid& signs, std::vector<RowBase>& bases, bool tubes, int threads) {
    bases.resize(signs.dims[1] * signs.dims[2]);
    std::vector<LayerCount> layers(signs.dims[2]);
    const Counter counter(signs, bases, tubes);
    parallel_for(threads, layers.size(), [&](std::size_t k) { layers[k] = counter.count(k); });
    return layers;
}

void number_vertices(std::vector<RowBase>& bases, std::size_t total) {
    if (total > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
        throw std::length_error(
            "the surface has more vertices than 2^31 - 1; crop the volume or choose another isovalue");
    }
    std::uint32_t next = 0;
    for (RowBase& row : bases) {
        for (std::uint32_t& axis : row) {
            const std::uint32_t count = axis;
            axis = next;
            next += count;
        }
    }
}

}  // namespace isocore::marching_cubes
