// renumber.hpp - Cells and values after points were numbered anew, as join_points.hpp does it.
#pragma once

#include <cstddef>
#include <cstdint>

#include "common/array.hpp"

namespace isocore {

// The new number of each corner. number: of each of `points` points. Throws std::out_of_range for a corner that is none
// of them.
Array<std::int32_t> renumbered(const std::int32_t* corners, std::size_t count, const std::int32_t* number,
                               std::size_t points);

// Has each of `count` points the value of the point that it became? joined: `left` values of those. Throws
// std::out_of_range for a number that is none of them.
template <class Value>
bool values_agree(const Value* values, std::size_t count, const std::int32_t* number, const Value* joined,
                  std::size_t left);

extern template bool values_agree(const float*, std::size_t, const std::int32_t*, const float*, std::size_t);
extern template bool values_agree(const double*, std::size_t, const std::int32_t*, const double*, std::size_t);

}  // namespace isocore
