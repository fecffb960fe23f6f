// arrays.hpp - How arrays cross the border between numpy and the kernels, without a copy either way.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "common/affine.hpp"
#include "common/array.hpp"
#include "common/grid.hpp"

namespace isocore::python {

namespace nb = nanobind;

template <class T>
using VolumeArray = nb::ndarray<const T, nb::ndim<3>, nb::f_contig, nb::device::cpu>;
template <class T, std::ptrdiff_t columns>
using Rows = nb::ndarray<const T, nb::shape<-1, columns>, nb::c_contig, nb::device::cpu>;
template <class T>
using Vector = nb::ndarray<const T, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

using AffineArray = nb::ndarray<const double, nb::shape<3, 4>, nb::c_contig, nb::device::cpu>;

inline Affine to_affine(const AffineArray& array) {
    Affine affine;
    std::copy_n(array.data(), affine.size(), affine.begin());
    return affine;
}

template <class T>
GridView<T> grid_view(const VolumeArray<T>& samples) {
    return {samples.data(), {samples.shape(0), samples.shape(1), samples.shape(2)}};
}

// Hand an Array over to numpy as (size / columns, columns), or one-dimensional when columns is 0. The GIL must be held.
template <class T>
nb::object to_numpy(Array<T>&& values, std::size_t columns = 0) {
    auto* owned = new Array<T>(std::move(values));
    nb::capsule owner(owned, [](void* pointer) noexcept { delete static_cast<Array<T>*>(pointer); });
    if (columns == 0) {
        return nb::cast(nb::ndarray<nb::numpy, T, nb::ndim<1>>(owned->data(), {owned->size()}, owner));
    }
    return nb::cast(nb::ndarray<nb::numpy, T, nb::ndim<2>>(owned->data(), {owned->size() / columns, columns}, owner));
}

}  // namespace isocore::python
