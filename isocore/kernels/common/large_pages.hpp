// large_pages.hpp - Asks the system for large pages, where it has any and knows how: a large array that is filled at
// once costs fewer faults, and one that is read here and there costs fewer misses of address translation. And gives
// pages back that are no longer used.
#pragma once

#include <cstddef>
#include <cstdint>

#include "common/array.hpp"

#if defined(__linux__)
#include <sys/mman.h>
#endif
#if defined(__GLIBC__)
#include <malloc.h>
#endif

namespace isocore {

// For an array that was allocated, but not yet written to. Only advice: nothing depends on its success.
template <class T, class Allocator>
void ask_for_large_pages([[maybe_unused]] std::vector<T, Allocator>& array) {
#if defined(__linux__) && defined(MADV_HUGEPAGE)
    const auto begin = reinterpret_cast<std::uintptr_t>(array.data());
    const std::uintptr_t first = (begin + kLargePage - 1) & ~(kLargePage - 1),
                         end = (begin + array.capacity() * sizeof(T)) & ~(kLargePage - 1);
    if (first < end) static_cast<void>(madvise(reinterpret_cast<void*>(first), end - first, MADV_HUGEPAGE));
#endif
}

// An array of that size on large pages; its elements are not set.
template <class T>
Array<T> large_array(std::size_t size) {
    Array<T> array;
    array.reserve(size);
    ask_for_large_pages(array);
    array.resize(size);
    return array;
}

// Gives back to the system what was freed: the C library keeps it otherwise, and what follows in other sizes comes on
// top of it.
inline void return_freed_memory() {
#if defined(__GLIBC__)
    static_cast<void>(malloc_trim(0));
#endif
}

// From now on all threads take memory from one heap, but those that have one already. Else what a thread has freed
// stays with its own heap, where it is of no use to others. For a process that is ours alone: this is for all of its
// libraries.
inline void share_one_heap() {
#if defined(__GLIBC__)
    static_cast<void>(mallopt(M_ARENA_MAX, 1));
#endif
}

}  // namespace isocore
