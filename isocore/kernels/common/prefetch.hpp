// prefetch.hpp - Asks for memory ahead of its use, where the compiler can say so.
#pragma once

#if defined(__GNUC__) || defined(__clang__)
#define ISOCORE_PREFETCH(address) __builtin_prefetch(address)
#else
#define ISOCORE_PREFETCH(address) static_cast<void>(address)
#endif
