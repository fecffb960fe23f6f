// small_volumes.hpp - What tests of both volume methods share: noise, and whether a surface is closed.
#pragma once

#include <cstddef>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "common/grid.hpp"

template <class Sample>
std::vector<Sample> noise(const isocore::Dims& dims, int levels, unsigned seed) {
    std::mt19937 random(seed);
    std::vector<Sample> samples(dims[0] * dims[1] * dims[2]);
    for (Sample& sample : samples) sample = static_cast<Sample>(random() % static_cast<unsigned>(levels));
    return samples;
}

template <class Mesh>
bool closed_and_oriented(const Mesh& mesh) {
    std::map<std::pair<int, int>, int> sides;
    for (std::size_t t = 0; t < mesh.triangles.size(); t += 3) {
        for (std::size_t n = 0; n < 3; ++n) ++sides[{mesh.triangles[t + n], mesh.triangles[t + (n + 1) % 3]}];
    }
    for (const auto& [side, count] : sides) {
        if (count != 1 || sides.count({side.second, side.first}) == 0) return false;
    }
    return true;
}
