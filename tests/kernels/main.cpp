// One program, one line per file of tests. Runs under address and undefined-behaviour sanitizers: `make kernels`.
#include <cstdio>

void test_array();
void test_bits();
void test_crew();
void test_crossing();
void test_lanes();
void test_selection();
void test_signs();
void test_halvings();
void test_facets();
void test_meeting();
void test_simplification();
void test_polygons();
void test_in_order();
void test_intersections();
void test_cell_loops();
void test_cell_disks();
void test_climbing();
void test_marching_cubes();
void test_tubes();
void test_thinning();
void test_joining();
void test_clusters();
void test_waves();

int main() {
    test_array();
    test_bits();
    test_crew();
    test_crossing();
    test_lanes();
    test_selection();
    test_signs();
    test_halvings();
    test_facets();
    test_meeting();
    test_simplification();
    test_polygons();
    test_in_order();
    test_intersections();
    test_cell_loops();
    test_cell_disks();
    test_climbing();
    test_marching_cubes();
    test_tubes();
    test_thinning();
    test_joining();
    test_clusters();
    test_waves();
    std::puts("kernels: all checks hold");
}
