// padded_grid.hpp - Samples with an optional layer of outside ones around them, and the cells between them.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <type_traits>

#include "common/grid.hpp"
#include "thinning/grid/grid_thinning.hpp"

namespace isocore::thinning {

template <class Sample>
struct PaddedGrid {
    GridView<Sample> samples;
    std::size_t pad;
    bool below;
    Dims dims, cells;  // samples and cells per axis, padding included

    PaddedGrid(GridView<Sample> view, const GridOptions& options)
        : samples(view), pad(options.capped ? 1 : 0), below(options.below) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (view.dims[axis] < 2) throw std::invalid_argument("thinning needs two samples per axis");
            dims[axis] = view.dims[axis] + 2 * pad;
            cells[axis] = dims[axis] - 1;
        }
        if (dims[0] * dims[1] * dims[2] > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
            throw std::length_error(
                "the volume has more samples than thinning can name; crop it or choose another backend");
        }
    }

    std::size_t size() const { return dims[0] * dims[1] * dims[2]; }
    std::size_t cell_count() const { return cells[0] * cells[1] * cells[2]; }
    std::size_t id(const Dims& at) const { return at[0] + dims[0] * (at[1] + dims[1] * at[2]); }
    std::size_t step(std::size_t axis) const { return axis == 0 ? 1 : axis == 1 ? dims[0] : dims[0] * dims[1]; }
    Dims cell_at(std::size_t cell) const {
        const auto place = static_cast<std::uint32_t>(cell),
                   across = static_cast<std::uint32_t>(cells[0]);  // 32 bits divide faster
        const std::uint32_t row = place / across, rows = static_cast<std::uint32_t>(cells[1]);
        return {place - row * across, row % rows, row / rows};
    }

    bool is_padding(const Dims& at) const {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (at[axis] < pad || at[axis] >= dims[axis] - pad) return true;
        }
        return false;
    }
    Sample sample(const Dims& at) const { return samples.at(at[0] - pad, at[1] - pad, at[2] - pad); }

    // A sample as the inside rule orders it: higher is more inside, and what is always outside is minus infinity.
    double height(const Dims& at) const {
        if (pad && is_padding(at)) return -std::numeric_limits<double>::infinity();
        const Sample there = sample(at);
        if constexpr (std::is_floating_point_v<Sample>) {
            if (!std::isfinite(there)) return -std::numeric_limits<double>::infinity();
        }
        return below ? -static_cast<double>(there) : static_cast<double>(there);
    }
};

}  // namespace isocore::thinning
