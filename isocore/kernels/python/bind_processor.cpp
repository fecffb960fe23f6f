// bind_processor.cpp - Which of the compiled modules this processor can run.
#include "python/bindings.hpp"

namespace isocore::python {
namespace {

// AVX2, BMI and the rest of x86-64-v3, as both the processor and the operating system report them.
bool supports_v3() {
#if defined(__x86_64__) && (defined(__GNUC__) || defined(__clang__))
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2") &&
           __builtin_cpu_supports("popcnt") && __builtin_cpu_supports("fma");
#else
    return false;
#endif
}

}  // namespace

void bind_processor(nanobind::module_& module) { module.def("supports_v3", &supports_v3); }

}  // namespace isocore::python
