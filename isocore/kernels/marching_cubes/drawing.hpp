// drawing.hpp - Writes the triangles of rows of cells: every loop a disk, or, with `tubes`, two of a cell's loops one
// tube where the trilinear function says so. What a cell draws on its faces is the same, so neighbours need not know.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/grid.hpp"
#include "marching_cubes/cell_rows.hpp"
#include "marching_cubes/joint.hpp"
#include "samples/sample_reader.hpp"
#include "tables/cell_loops.hpp"
#include "tables/tubes.hpp"

namespace isocore::marching_cubes {

// Draws the cells of one row after the other, keeping the vertex numbers of the twelve edges at hand.
template <bool tubes>
class Drawer {
  public:
    Drawer(const SampleReader& samples, const SignGrid& signs, const std::vector<RowBase>& bases, double isovalue,
           bool below)
        : samples_(samples), signs_(signs), bases_(bases), isovalue_(isovalue), below_(below) {}

    std::size_t ambiguous_faces = 0, ambiguous_cells = 0, tubes_drawn = 0;

    // Writes the triangles of cell row (j, k) from `out` on, and returns the end. All before `limit` may be written to.
    std::int32_t* draw(std::size_t j, std::size_t k, std::int32_t* out, const std::int32_t* limit) {
        const CellRow rows(signs_, j, k);
        const std::size_t row = j + signs_.dims[1] * k, above = row + signs_.dims[1];
        // Numbers of the first crossing, of this row of cells, along: x (4 rows), y (2 planes), z (2 rows).
        std::array<std::uint32_t, 8> base{bases_[row][0], bases_[row + 1][0], bases_[above][0], bases_[above + 1][0],
                                          bases_[row][1], bases_[above][1],   bases_[row][2],   bases_[row + 1][2]};
        for (std::size_t w = 0; w < signs_.words; ++w) {
            const Word valid = signs_.valid(w, 1), in_row = signs_.valid(w);
            std::array<Word, 4> here, next;
            for (int n = 0; n < 4; ++n) {
                here[static_cast<std::size_t>(n)] = rows.here(n, w);
                next[static_cast<std::size_t>(n)] = rows.next(n, w);
            }
            const std::array<Word, 8> crossed{(here[0] ^ next[0]) & valid,  (here[1] ^ next[1]) & valid,
                                              (here[2] ^ next[2]) & valid,  (here[3] ^ next[3]) & valid,
                                              (here[0] ^ here[1]) & in_row, (here[2] ^ here[3]) & in_row,
                                              (here[0] ^ here[2]) & in_row, (here[1] ^ here[3]) & in_row};
            for (Word left = rows.active(w, valid); left != 0; left &= left - 1) {
                const int x = std::countr_zero(left);
                unsigned corners = 0;
                for (unsigned n = 0; n < 4; ++n)
                    corners |= static_cast<unsigned>((here[n] >> x & 1) | (next[n] >> x & 1) << 1) << 2 * n;
                const std::size_t i = 64 * w + static_cast<std::size_t>(x);
                const cell_loops::Case& drawn = decided(corners, i, j, k);
                const auto numbers = edge_numbers(base, crossed, x);
                if constexpr (tubes) {
                    if (drawn.loops > 1) {
                        if (const Tube* tube = find_tube(drawn, corners, {i, j, k})) {
                            out = write(tube->drawn, numbers, out, limit);
                            ++tubes_drawn;
                            continue;
                        }
                    }
                }
                out = write(drawn, numbers, out, limit);
            }
            for (std::size_t n = 0; n < 8; ++n) base[n] += ones(crossed[n]);
        }
        return out;
    }

  private:
    // Nearly every cell has at most five triangles. Writing always five, and keeping as many as there are, is a loop of
    // fixed length: one of the cell's own length would end in a branch misprediction.
    template <class AnyCase>
    static std::int32_t* write(const AnyCase& drawn, const std::array<std::uint32_t, 12>& numbers, std::int32_t* out,
                               const std::int32_t* limit) {
        const unsigned count = 3u * drawn.triangles, usual = 15;
        if (count <= usual && limit - out >= static_cast<std::ptrdiff_t>(usual)) {
            for (unsigned n = 0; n < usual; ++n) out[n] = static_cast<std::int32_t>(numbers[drawn.edges[n]]);
        } else {
            for (unsigned n = 0; n < count; ++n) out[n] = static_cast<std::int32_t>(numbers[drawn.edges[n]]);
        }
        return out + count;
    }

    // The vertex numbers of a cell's twelve edges (cube.hpp's order); those of edges that are not crossed mean nothing.
    static std::array<std::uint32_t, 12> edge_numbers(const std::array<std::uint32_t, 8>& base,
                                                      const std::array<Word, 8>& crossed, int x) {
        const Word below = (Word{1} << x) - 1;
        std::array<std::uint32_t, 12> numbers;
        for (std::size_t n = 0; n < 4; ++n) numbers[n] = base[n] + ones(crossed[n] & below);
        for (std::size_t n = 4; n < 8; ++n) {
            const std::size_t low = 2 * n - 4;
            numbers[low] = base[n] + ones(crossed[n] & below);
            numbers[low + 1] = numbers[low] + static_cast<std::uint32_t>(crossed[n] >> x & 1);
        }
        return numbers;
    }

    const cell_loops::Case& decided(unsigned corners, std::size_t i, std::size_t j, std::size_t k) {
        const cell_loops::Corners& entry = cell_loops::kTable.corners[corners];
        if (entry.ambiguous == 0) return cell_loops::kTable.cases[entry.first];
        ++ambiguous_cells;
        ambiguous_faces += static_cast<std::size_t>(std::popcount(unsigned{entry.ambiguous}));
        return cell_loops::kTable.cases[entry.first + samples_.decide_faces(corners, {i, j, k})];
    }

    // The tube of a cell of several loops, or null. Beyond the border everything is outside, and nothing meets there.
    const Tube* find_tube(const cell_loops::Case& drawn, unsigned corners, const Dims& cell) const {
        for (std::size_t c = 0; c < 8; ++c) {
            const Dims at{cell[0] + (c & 1), cell[1] + (c >> 1 & 1), cell[2] + (c >> 2)};
            for (std::size_t axis = 0; axis < 3; ++axis) {
                if (at[axis] < signs_.pad || at[axis] >= signs_.dims[axis] - signs_.pad) return nullptr;
            }
        }
        std::array<double, 8> values = samples_.corners(cell);
        for (double& value : values) {
            value = below_ ? isovalue_ - value : value - isovalue_;
            if (!std::isfinite(value)) return nullptr;
        }
        const Joint joint = find_joint(values, corners);
        const auto number = static_cast<std::size_t>(&drawn - cell_loops::kTable.cases.data());
        for (std::size_t n = kTubeTable.first[number]; n < kTubeTable.first[number + 1]; ++n) {
            const Tube& tube = kTubeTable.tubes[n];
            const bool forward = (tube.one >> joint.a & 1) && (tube.other >> joint.b & 1);
            const bool backward = (tube.one >> joint.b & 1) && (tube.other >> joint.a & 1);
            if (forward || backward) return &tube;
        }
        return nullptr;
    }

    const SampleReader& samples_;
    const SignGrid& signs_;
    const std::vector<RowBase>& bases_;
    double isovalue_;
    bool below_;
};

}  // namespace isocore::marching_cubes
