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
#include <vector>

#include "climbing/high_rice.hpp"
#include "common/array.hpp"
#include "common/edge_vertices.hpp"

namespace isocore::climbing {

struct GridEdge {
    int axis;
    Dims low;
};

class Layout {
  public:
    explicit Layout(const SignGrid& signs) : signs_(signs), rows_(signs.dims[1] * signs.dims[2]) {
        for (auto& axis : marks_) axis.assign(rows_ * signs.words, 0);
        bases_.resize(rows_);
    }

    void mark(const Dims& origin, const HighRice& box) {
        const std::size_t x0 = origin[0] + box.low[0], x1 = origin[0] + box.high[0];
        const std::size_t y0 = origin[1] + box.low[1], y1 = origin[1] + box.high[1];
        const std::size_t z0 = origin[2] + box.low[2], z1 = origin[2] + box.high[2];
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

    // Marks a late box and notes the crossed edges that were not kept before.
    void insert(const Dims& origin, const HighRice& box, std::vector<GridEdge>& inserted) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const std::size_t u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
            for (const std::size_t at_u : {box.low[u], box.high[u]}) {
                for (const std::size_t at_v : {box.low[v], box.high[v]}) {
                    for (std::size_t along = box.low[axis]; along < box.high[axis]; ++along) {
                        GridEdge edge{static_cast<int>(axis), origin};
                        edge.low[u] += at_u, edge.low[v] += at_v, edge.low[axis] += along;
                        const auto [i, j, k] = edge.low;
                        std::uint64_t& kept = word(edge.axis, i / 64, j, k);
                        const std::uint64_t bit = std::uint64_t{1} << i % 64;
                        if ((kept & bit) || !(crossed_edges(signs_, edge.axis, j, k, i / 64) & bit)) continue;
                        kept |= bit;
                        inserted.push_back(edge);
                    }
                }
            }
        }
    }

    // The vertex number of a kept edge.
    std::size_t number(const GridEdge& edge) const {
        const auto [i, j, k] = edge.low;
        const std::uint64_t* bits = row(static_cast<std::size_t>(edge.axis), j, k);
        std::size_t out = base(j, k)[static_cast<std::size_t>(edge.axis)];
        for (std::size_t w = 0; w < i / 64; ++w) out += static_cast<std::size_t>(std::popcount(bits[w]));
        return out + static_cast<std::size_t>(std::popcount(bits[i / 64] & ((std::uint64_t{1} << i % 64) - 1)));
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

    // Turns counts into numbers, once; returns the number of vertices.
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
    const std::uint64_t* row(std::size_t axis, std::size_t j, std::size_t k) const {
        return marks_[axis].data() + (j + signs_.dims[1] * k) * signs_.words;
    }

  private:
    std::uint64_t& word(int axis, std::size_t w, std::size_t j, std::size_t k) {
        return marks_[static_cast<std::size_t>(axis)][(j + signs_.dims[1] * k) * signs_.words + w];
    }

    const SignGrid& signs_;
    std::size_t rows_;
    std::array<Array<std::uint64_t>, 3> marks_;
    Array<RowBase> bases_;
};

}  // namespace isocore::climbing
