// array.hpp - A std::vector that leaves new elements uninitialised: kernels fill what they resize. One that is larger
// than a large page begins on the border of one, so that it can be filled with few faults: large_pages.hpp.
#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

namespace isocore {

inline constexpr std::size_t kLargePage = std::size_t{1} << 21;  // bytes

template <class T>
struct LeaveUninitialised : std::allocator<T> {
    using std::allocator<T>::allocator;
    template <class U>
    struct rebind {
        using other = LeaveUninitialised<U>;
    };
    T* allocate(std::size_t count) {
        if (count < kFewest) return std::allocator<T>::allocate(count);
        return static_cast<T*>(::operator new(count * sizeof(T), std::align_val_t{kLargePage}));
    }
    void deallocate(T* array, std::size_t count) noexcept {
        if (count < kFewest) return std::allocator<T>::deallocate(array, count);
        ::operator delete(array, std::align_val_t{kLargePage});
    }
    template <class U>
    void construct(U* place) noexcept(std::is_nothrow_default_constructible_v<U>) {
        ::new (static_cast<void*>(place)) U;
    }
    template <class U, class... Args>
    void construct(U* place, Args&&... args) {
        std::construct_at(place, std::forward<Args>(args)...);
    }

  private:
    static constexpr std::size_t kFewest = kLargePage / sizeof(T);  // that fill a page
};

template <class T>
using Array = std::vector<T, LeaveUninitialised<T>>;

}  // namespace isocore
