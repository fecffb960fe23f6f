// array.hpp - A std::vector that leaves new elements uninitialised: kernels fill what they resize.
#pragma once

#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

namespace isocore {

template <class T>
struct LeaveUninitialised : std::allocator<T> {
    using std::allocator<T>::allocator;
    template <class U>
    struct rebind {
        using other = LeaveUninitialised<U>;
    };
    template <class U>
    void construct(U* place) noexcept(std::is_nothrow_default_constructible_v<U>) {
        ::new (static_cast<void*>(place)) U;
    }
    template <class U, class... Args>
    void construct(U* place, Args&&... args) {
        std::construct_at(place, std::forward<Args>(args)...);
    }
};

template <class T>
using Array = std::vector<T, LeaveUninitialised<T>>;

}  // namespace isocore
