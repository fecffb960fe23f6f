// One program, one line per file of tests. Runs under address and undefined-behaviour sanitizers: `make kernels`.
#include <cstdio>

void test_crossing();
void test_cell_loops();
void test_marching_cubes();

int main() {
    test_crossing();
    test_cell_loops();
    test_marching_cubes();
    std::puts("kernels: all checks hold");
}
