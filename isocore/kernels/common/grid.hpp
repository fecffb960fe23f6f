// grid.hpp - A view of samples on a grid: i fastest, then j, then k.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

namespace isocore {

using Dims = std::array<std::size_t, 3>;

template <class Sample>
struct GridView {
    const Sample* data;
    Dims dims;

    std::size_t index(std::size_t i, std::size_t j, std::size_t k) const { return i + dims[0] * (j + dims[1] * k); }
    Sample at(std::size_t i, std::size_t j, std::size_t k) const { return data[index(i, j, k)]; }
    const Sample* row(std::size_t j, std::size_t k) const { return data + index(0, j, k); }
    // Samples between neighbours along an axis.
    std::size_t step(int axis) const {
        return std::array<std::size_t, 3>{1, dims[0], dims[0] * dims[1]}[static_cast<std::size_t>(axis)];
    }
    std::size_t size() const { return dims[0] * dims[1] * dims[2]; }
};

// Are float32 coordinates in index space fine enough? Up to 8192 samples along every axis they are: float32 then has
// steps of at most 2^-11, and a vertex keeps 2^-10 of an edge away from every sample (kClamp in crossing.hpp), so that
// two vertices on one grid line stay apart. For longer volumes callers take float64.
inline bool floats_suffice(const Dims& dims) {
    constexpr std::size_t kLongest = 8192;
    return *std::max_element(dims.begin(), dims.end()) <= kLongest;
}

}  // namespace isocore
