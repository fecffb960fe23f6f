// weld.hpp - Vertices joined by position, as readers do with formats that share none.
#pragma once

#include <cstddef>
#include <cstdint>

#include "common/array.hpp"

namespace isocore {

// For each of `count` vertices (count, 3) the earliest one at the same place; empty if no two share a place. Zero and
// minus zero are one place. The same result for any number of threads.
template <class Real>
Array<std::int32_t> weld(const Real* vertices, std::size_t count, int threads);

}  // namespace isocore
