// zeroed.hpp - Scratch memory that starts as zeros. The operating system hands its pages out as they are first
// written to, so a large array costs no more than what is used of it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>

namespace isocore::thinning {

class Zeroed {
  public:
    Zeroed() : Zeroed(0) {}
    explicit Zeroed(std::size_t count)
        : numbers_(static_cast<std::int32_t*>(std::calloc(std::max<std::size_t>(count, 1), sizeof(std::int32_t)))) {
        if (!numbers_) throw std::bad_alloc();
    }
    std::int32_t* data() const { return numbers_.get(); }

  private:
    struct Free {
        void operator()(std::int32_t* numbers) const { std::free(numbers); }
    };
    std::unique_ptr<std::int32_t[], Free> numbers_;
};

}  // namespace isocore::thinning
