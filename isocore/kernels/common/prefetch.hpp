// prefetch.hpp - Asks for memory ahead of its use, where the compiler can say so.
#pragma once

// GCC takes a function that does nothing but prefetch for one without any effect and drops the calls of it; the empty
// statement in assembler keeps them.
#if defined(__GNUC__) || defined(__clang__)
#define ISOCORE_PREFETCH(address)    \
    do {                             \
        __builtin_prefetch(address); \
        __asm__ volatile("");        \
    } while (false)
#else
#define ISOCORE_PREFETCH(address) static_cast<void>(address)
#endif
