// probe.cpp - ISOCORE_ISA=native: CMake runs this when it configures; 0 means that this machine runs `_kernels_v3`.
#include "processor/supports_v3.hpp"

int main() { return isocore::supports_v3() ? 0 : 1; }
