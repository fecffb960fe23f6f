// renumber.cpp - Both passes look up the same number per point; a stretch of them that fits the fastest cache is
// checked first, so that the loop behind it has no branches.
#include "joining/renumber.hpp"

#include <algorithm>
#include <stdexcept>

#include "common/large_pages.hpp"

namespace isocore {
namespace {

constexpr std::size_t kStretch = 4096;

void check_range(const std::int32_t* numbers, std::size_t count, std::size_t end) {
    std::uint32_t largest = 0;  // a negative number is a large one here
    for (std::size_t n = 0; n < count; ++n) largest = std::max(largest, static_cast<std::uint32_t>(numbers[n]));
    if (count != 0 && largest >= end) throw std::out_of_range("a number names no point");
}

}  // namespace

Array<std::int32_t> renumbered(const std::int32_t* corners, std::size_t count, const std::int32_t* number,
                               std::size_t points) {
    auto result = large_array<std::int32_t>(count);
    for (std::size_t first = 0; first < count; first += kStretch) {
        const std::size_t end = std::min(count, first + kStretch);
        check_range(corners + first, end - first, points);
        for (std::size_t n = first; n < end; ++n) result[n] = number[corners[n]];
    }
    return result;
}

template <class Value>
bool values_agree(const Value* values, std::size_t count, const std::int32_t* number, const Value* joined,
                  std::size_t left) {
    for (std::size_t first = 0; first < count; first += kStretch) {
        const std::size_t end = std::min(count, first + kStretch);
        check_range(number + first, end - first, left);
        std::size_t differing = 0;
        for (std::size_t n = first; n < end; ++n) differing += values[n] != joined[number[n]];
        if (differing != 0) return false;
    }
    return true;
}

template bool values_agree(const float*, std::size_t, const std::int32_t*, const float*, std::size_t);
template bool values_agree(const double*, std::size_t, const std::int32_t*, const double*, std::size_t);

}  // namespace isocore
