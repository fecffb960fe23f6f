// check_numbers.hpp - Are numbers such that they may be looked up?
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <stdexcept>

namespace isocore {

// Throws std::out_of_range where one of `count` numbers is not from 0 to end - 1. Without a branch for each of them.
inline void check_numbers(const std::int32_t* numbers, std::size_t count, std::size_t end) {
    std::uint32_t largest = 0;  // a negative number is a large one here
    for (std::size_t n = 0; n < count; ++n) largest = std::max(largest, static_cast<std::uint32_t>(numbers[n]));
    if (count != 0 && largest >= end) throw std::out_of_range("a number names no point");
}

}  // namespace isocore
