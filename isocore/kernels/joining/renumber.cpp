// renumber.cpp - Both passes look up the same number per point; a stretch of them that fits the fastest cache is
// checked first, so that the loop behind it has no branches.
#include "joining/renumber.hpp"

#include <algorithm>

#include "common/check_numbers.hpp"
#include "common/large_pages.hpp"

namespace isocore {
namespace {

constexpr std::size_t kStretch = 4096;

}  // namespace

Array<std::int32_t> renumbered(const std::int32_t* corners, std::size_t count, const std::int32_t* number,
                               std::size_t points) {
    auto result = large_array<std::int32_t>(count);
    for (std::size_t first = 0; first < count; first += kStretch) {
        const std::size_t end = std::min(count, first + kStretch);
        check_numbers(corners + first, end - first, points);
        for (std::size_t n = first; n < end; ++n) result[n] = number[corners[n]];
    }
    return result;
}

template <class Value>
bool values_agree(const Value* values, std::size_t count, const std::int32_t* number, const Value* joined,
                  std::size_t left) {
    for (std::size_t first = 0; first < count; first += kStretch) {
        const std::size_t end = std::min(count, first + kStretch);
        check_numbers(number + first, end - first, left);
        std::size_t differing = 0;
        for (std::size_t n = first; n < end; ++n) differing += values[n] != joined[number[n]];
        if (differing != 0) return false;
    }
    return true;
}

template bool values_agree(const float*, std::size_t, const std::int32_t*, const float*, std::size_t);
template bool values_agree(const double*, std::size_t, const std::int32_t*, const double*, std::size_t);

}  // namespace isocore
