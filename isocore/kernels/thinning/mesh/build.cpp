// build.cpp - From a mesh to its index: cells in a good order, gluing, thinning, ranges of the skeleton.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "common/parallel.hpp"
#include "thinning/mesh/thinner.hpp"
#include "thinning/mesh/thinning.hpp"

namespace isocore::thinning {
namespace {

using mesh::Field;
using mesh::Hex;
using mesh::Tet;
using std::int32_t;
using std::size_t;

template <class Cell>
Part make_part(Gluing<Cell>&& gluing, const Array<double>& heights, Work work) {
    Part part;
    if (gluing.cells == 0) return part;
    const Skeleton skeleton = thin(gluing, heights, work);
    std::vector<std::pair<double, int32_t>> by_low(skeleton.cells.size());
    std::vector<double> highest(skeleton.cells.size());
    for (size_t n = 0; n < skeleton.cells.size(); ++n) {
        const int32_t* ids = gluing.record(static_cast<size_t>(skeleton.cells[n]));
        double low = heights[static_cast<size_t>(ids[0])], high = low;
        for (size_t corner = 1; corner < Cell::kCorners; ++corner) {
            low = std::min(low, heights[static_cast<size_t>(ids[corner])]);
            high = std::max(high, heights[static_cast<size_t>(ids[corner])]);
        }
        by_low[n] = {low, static_cast<int32_t>(n)};
        highest[n] = high;
    }
    std::sort(by_low.begin(), by_low.end());
    for (const auto& [low, n] : by_low) {
        part.skeleton.push_back(skeleton.cells[static_cast<size_t>(n)]);
        part.low.push_back(low);
        part.high.push_back(highest[static_cast<size_t>(n)]);
    }
    part.classes = classes_of(gluing, skeleton.cells);
    part.extrema = skeleton.extrema;
    part.oddities = gluing.oddities;
    part.records = std::move(gluing.records);
    return part;
}

}  // namespace

template <class Value>
Index build(const Field<Value>& field, const Cells& cells, Work work) {
    const int threads = work.threads;
    PointOrder points = order_points(field.points, field.size, threads);
    Array<double> heights(field.size);
    constexpr size_t kChunk = size_t{1} << 16;
    parallel_for(threads, field.size / kChunk + 1, [&](size_t chunk) {
        const size_t end = std::min(field.size, (chunk + 1) * kChunk);
        for (size_t n = chunk * kChunk; n < end; ++n) heights[n] = field.height(points.original[n]);
    });
    Index index;
    index.tets = make_part(glue<Tet>(field, cells.tets, cells.tet_count, points, threads), heights, work);
    index.hexes = make_part(glue<Hex>(field, cells.hexes, cells.hex_count, points, threads), heights, work);
    index.points = std::move(points.original);
    return index;
}

template Index build<float>(const Field<float>&, const Cells&, Work);
template Index build<double>(const Field<double>&, const Cells&, Work);

}  // namespace isocore::thinning
