// layout.hpp - How neighbours share their cuts. The paper lays out every face again after comparing the cuts of the
// highrices on both sides; here both sides mark the grid edges on the twelve edges of their boxes in one set of bits,
// and the marked edges that are crossed are the mesh's vertices.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <stdexcept>

#include "climbing/high_rice.hpp"
#include "common/array.hpp"
#include "common/edge_vertices.hpp"

namespace isocore::climbing {

class Layout {
  public:
    explicit Layout(const SignGrid& signs) : signs_(signs), rows_(signs.dims[1] * signs.dims[2]) {
        for (auto& axis : marks_) axis.assign(rows_ * signs.words, 0);
        bases_.resize(rows_);
    }

    void mark(const HighRice& box) {
        const auto [x0, y0, z0] = places(box.low);
        const auto [x1, y1, z1] = places(box.high);
        const std::uint64_t along = (std::uint64_t{2} << (x1 - 1) % 64) - (std::uint64_t{1} << x0 % 64);
        for (const std::size_t j : {y0, y1}) {
            for (const std::size_t k : {z0, z1}) word(0, x0 / 64, j, k) |= along;
        }
        for (const std::size_t i : {x0, x1}) {
            const std::uint64_t bit = std::uint64_t{1} << i % 64;
            for (const std::size_t k : {z0, z1}) {
                for (std::size_t j = y0; j < y1; ++j) word(1, i / 64, j, k) |= bit;
            }
            for (const std::size_t j : {y0, y1}) {
                for (std::size_t k = z0; k < z1; ++k) word(2, i / 64, j, k) |= bit;
            }
        }
    }

    // Keeps of the marks those that are crossed, and counts them.
    void count_row(std::size_t j, std::size_t k) {
        RowBase& counts = bases_[j + signs_.dims[1] * k];
        counts = {};
        for (int axis = 0; axis < 3; ++axis) {
            for (std::size_t w = 0; w < signs_.words; ++w) {
                std::uint64_t& marks = word(axis, w, j, k);
                marks &= crossed_edges(signs_, axis, j, k, w);
                counts[static_cast<std::size_t>(axis)] += static_cast<std::uint32_t>(std::popcount(marks));
            }
        }
    }

    // Turns counts into numbers; returns the number of vertices.
    std::size_t number() {
        std::size_t next = 0;
        for (RowBase& row : bases_) {
            for (std::uint32_t& axis : row) {
                const std::uint32_t count = axis;
                axis = static_cast<std::uint32_t>(next);
                next += count;
            }
            if (next > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
                throw std::length_error("the surface has more vertices than 2^31 - 1; crop the volume or choose another isovalue");
            }
        }
        return next;
    }

    // Vertices of a row's edges along each axis.
    RowBase row_counts(std::size_t j, std::size_t k) const {
        RowBase counts{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            for (std::size_t w = 0; w < signs_.words; ++w) {
                counts[axis] += static_cast<std::uint32_t>(std::popcount(kept(static_cast<int>(axis), w, j, k)));
            }
        }
        return counts;
    }

    const RowBase& base(std::size_t j, std::size_t k) const { return bases_[j + signs_.dims[1] * k]; }
    std::uint64_t kept(int axis, std::size_t w, std::size_t j, std::size_t k) const {
        return marks_[static_cast<std::size_t>(axis)][(j + signs_.dims[1] * k) * signs_.words + w];
    }
    bool is_kept(int axis, std::size_t i, std::size_t j, std::size_t k) const { return kept(axis, i / 64, j, k) >> i % 64 & 1; }

    // The vertex number of a kept edge.
    std::uint32_t vertex(int axis, std::size_t i, std::size_t j, std::size_t k) const {
        std::uint32_t number = base(j, k)[static_cast<std::size_t>(axis)];
        for (std::size_t w = 0; w < i / 64; ++w) number += static_cast<std::uint32_t>(std::popcount(kept(axis, w, j, k)));
        const std::uint64_t below = (std::uint64_t{1} << i % 64) - 1;
        return number + static_cast<std::uint32_t>(std::popcount(kept(axis, i / 64, j, k) & below));
    }

  private:
    static std::array<std::size_t, 3> places(const std::array<std::int32_t, 3>& sample) {
        return {static_cast<std::size_t>(sample[0]), static_cast<std::size_t>(sample[1]), static_cast<std::size_t>(sample[2])};
    }
    std::uint64_t& word(int axis, std::size_t w, std::size_t j, std::size_t k) {
        return marks_[static_cast<std::size_t>(axis)][(j + signs_.dims[1] * k) * signs_.words + w];
    }

    const SignGrid& signs_;
    std::size_t rows_;
    std::array<Array<std::uint64_t>, 3> marks_;
    Array<RowBase> bases_;
};

}  // namespace isocore::climbing
