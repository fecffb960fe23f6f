// Arrays that begin on the border of a large page once they fill one.
#include <cstddef>
#include <cstdint>
#include <numeric>

#include "check.hpp"
#include "common/array.hpp"
#include "common/large_pages.hpp"

namespace {

using namespace isocore;

constexpr std::size_t kFills = kLargePage / sizeof(std::int32_t);

bool is_on_border(const Array<std::int32_t>& array) {
    return reinterpret_cast<std::uintptr_t>(array.data()) % kLargePage == 0;
}

void arrays_that_fill_a_large_page_begin_on_its_border() {
    for (const std::size_t size : {kFills, kFills + 1, 3 * kFills - 7}) {
        CHECK(is_on_border(Array<std::int32_t>(size)));
        CHECK(is_on_border(large_array<std::int32_t>(size)));
    }
}

void an_array_that_outgrows_a_page_keeps_what_it_holds() {
    Array<std::int32_t> array(kFills - 1);
    std::iota(array.begin(), array.end(), 0);
    array.resize(2 * kFills, -1);
    CHECK(is_on_border(array));
    for (std::size_t n = 0; n < array.size(); ++n)
        CHECK(array[n] == (n < kFills - 1 ? static_cast<std::int32_t>(n) : -1));
    array.resize(5);
    array.shrink_to_fit();
    CHECK(array.size() == 5 && array.back() == 4);
}

}  // namespace

void test_array() {
    arrays_that_fill_a_large_page_begin_on_its_border();
    an_array_that_outgrows_a_page_keeps_what_it_holds();
}
