// narrow_array.hpp - Numbers in 16 bits each where none of them needs more, else in 32.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "common/array.hpp"

namespace isocore {

class NarrowArray {
  public:
    NarrowArray() = default;
    // So many, of which none will be larger than `largest`; they are not set.
    NarrowArray(std::size_t size, std::size_t largest) {
        if (largest <= std::numeric_limits<std::uint16_t>::max())
            narrow_.resize(size);
        else
            wide_.resize(size);
    }

    std::size_t size() const { return narrow_.size() + wide_.size(); }
    std::uint32_t operator[](std::size_t n) const { return wide_.empty() ? narrow_[n] : wide_[n]; }
    void set(std::size_t n, std::uint32_t number) {
        if (wide_.empty())
            narrow_[n] = static_cast<std::uint16_t>(number);
        else
            wide_[n] = number;
    }

  private:
    Array<std::uint16_t> narrow_;
    Array<std::uint32_t> wide_;
};

}  // namespace isocore
