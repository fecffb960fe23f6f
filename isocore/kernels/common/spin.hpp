// spin.hpp - Waiting for another thread for so short a time that to sleep and be woken would take longer.
#pragma once

#if defined(__x86_64__) || defined(_M_X64)
#include <immintrin.h>
#endif

namespace isocore {

// Tells the processor that this is a loop that waits.
inline void pause() {
#if defined(__x86_64__) || defined(_M_X64)
    _mm_pause();
#elif defined(__aarch64__) && defined(__GNUC__)
    asm volatile("isb");
#endif
}

// Waits until done() is true, but for some 50 microseconds at most. Returns whether it is. Does not yield: another
// process might keep the processor for a hundred times as long.
template <class Done>
bool spin_until(const Done& done) {
    constexpr int kPatience = 2048;
    for (int n = 0; n < kPatience; ++n) {
        if (done()) return true;
        pause();
    }
    return done();
}

}  // namespace isocore
