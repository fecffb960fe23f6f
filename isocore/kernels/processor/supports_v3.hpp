// supports_v3.hpp - Whether this processor runs what `_kernels_v3` is compiled for. Only code of the baseline may
// include this: it must run everywhere.
#pragma once

#if defined(_MSC_VER) && defined(_M_X64)
#include <intrin.h>
#endif

namespace isocore {

// AVX2, BMI and the rest of x86-64-v3, as both the processor and the operating system report them.
inline bool supports_v3() {
#if defined(_MSC_VER) && defined(_M_X64)
    int basic[4], extended[4];
    __cpuid(basic, 0);
    if (basic[0] < 7) return false;
    __cpuid(basic, 1);
    __cpuidex(extended, 7, 0);
    constexpr int kBasic = 1 << 12 | 1 << 23 | 1 << 27 | 1 << 28;  // ecx: FMA, POPCNT, OSXSAVE, AVX
    constexpr int kExtended = 1 << 3 | 1 << 5 | 1 << 8;            // ebx: BMI1, AVX2, BMI2
    constexpr unsigned long long kVectors = 6;                     // the system keeps XMM and YMM registers
    return (basic[2] & kBasic) == kBasic && (extended[1] & kExtended) == kExtended &&
           (_xgetbv(0) & kVectors) == kVectors;
#elif defined(__x86_64__) && (defined(__GNUC__) || defined(__clang__))
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2") &&
           __builtin_cpu_supports("popcnt") && __builtin_cpu_supports("fma");
#else
    return false;
#endif
}

}  // namespace isocore
