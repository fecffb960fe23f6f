// inlined.hpp - For small functions in loops that must become vector instructions: a compiler that has inlined much
// already may leave them as calls, and then the loops stay scalar.
#pragma once

#if defined(_MSC_VER)
#define ISOCORE_INLINED __forceinline
#else
#define ISOCORE_INLINED [[gnu::always_inline]] inline
#endif
