// build.cpp - From a mesh to its index: cells in a good order, gluing, thinning, ranges of the skeleton.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "thinning/mesh/renumbering.hpp"
#include "thinning/mesh/thinner.hpp"
#include "thinning/mesh/thinning.hpp"

namespace isocore::thinning {
namespace {

using mesh::Field;
using mesh::Hex;
using mesh::Tet;
using std::int32_t;
using std::size_t;

// One number for all edges between the same two points, be they copies of each other or edges of both kinds of cells.
class EdgeNumbers {
  public:
    explicit EdgeNumbers(size_t points) : start_(points + 1) {}

    // Takes in the edge copies of one part: first those of the tetrahedra, which are part 0, then the hexahedra's.
    template <class Cell>
    void add(const Gluing<Cell>& gluing) {
        ends_.resize(first_.empty() ? gluing.edge_count : ends_.size() + gluing.edge_count);
        first_.push_back(ends_.size() - gluing.edge_count);
        for (size_t n = 0; n < gluing.edges.size(); ++n) {
            const auto& corners = Cell::kShape.ends[n % Cell::kEdges];
            const int32_t* ids = gluing.corners.data() + Cell::kCorners * (n / Cell::kEdges);
            const int32_t a = ids[corners[0]], b = ids[corners[1]];
            ends_[first_.back() + static_cast<size_t>(gluing.edges[n])] = {std::min(a, b), std::max(a, b)};
        }
    }

    // Gives equal edges the number of the first, and closes the gaps that leaves.
    void merge() {
        for (const auto& [low, high] : ends_) ++start_[static_cast<size_t>(low) + 1];
        for (size_t n = 1; n < start_.size(); ++n) start_[n] += start_[n - 1];
        Array<std::pair<int32_t, int32_t>> leaving(ends_.size());  // high point, edge
        for (size_t n = 0; n < ends_.size(); ++n)
            leaving[start_[static_cast<size_t>(ends_[n].first)]++] = {ends_[n].second, static_cast<int32_t>(n)};
        number_.resize(ends_.size());
        std::iota(number_.begin(), number_.end(), 0);
        bool equal = false;
        for (size_t point = 0, begin = 0; point + 1 < start_.size();
             begin = start_[point++]) {  // scattering moved every start to the end
            const auto from = leaving.begin() + static_cast<std::ptrdiff_t>(begin),
                       to = leaving.begin() + static_cast<std::ptrdiff_t>(start_[point]);
            std::sort(from, to);
            for (auto it = from; it != to; ++it) {
                if (it == from || it->first != (it - 1)->first) continue;
                number_[static_cast<size_t>(it->second)] = number_[static_cast<size_t>((it - 1)->second)];
                equal = true;
            }
        }
        count_ = ends_.size();
        if (!equal) return;
        std::vector<int32_t> dense(ends_.size());
        int32_t next = 0;
        for (size_t n = 0; n < number_.size(); ++n) dense[n] = number_[n] == static_cast<int32_t>(n) ? next++ : -1;
        for (int32_t& number : number_) number = dense[static_cast<size_t>(number)];
        count_ = static_cast<size_t>(next);
    }

    int32_t operator()(size_t part, int32_t edge) const { return number_[first_[part] + static_cast<size_t>(edge)]; }
    size_t count() const { return count_; }

  private:
    std::vector<std::uint32_t> start_;
    std::vector<size_t> first_;
    std::vector<std::pair<int32_t, int32_t>> ends_;
    std::vector<int32_t> number_;
    size_t count_ = 0;
};

// The cells of one kind: turned upright, along a Morton curve, naming points by their new numbers; then glued.
template <class Cell, class Value>
Gluing<Cell> glue_in_order(const Field<Value>& field, const int32_t* cells, size_t count, PointNumbers& numbers) {
    const auto order = morton_order(field.points, field.size, cells, count, Cell::kCorners);
    Array<int32_t> corners(Cell::kCorners * count);
    int32_t* out = corners.data();
    for (const std::uint32_t cell : order) {
        for (const int32_t point : mesh::upright<Cell>(field, cells + Cell::kCorners * cell)) *out++ = numbers(point);
    }
    Gluing<Cell> gluing = glue<Cell>(std::move(corners), field.size);
    const auto original = [&](int32_t& cell) {
        if (cell >= 0) cell = static_cast<int32_t>(order[static_cast<size_t>(cell)]);
    };
    for (int32_t& cell : gluing.oddities.crowded_cells) original(cell);
    original(gluing.oddities.collapsed_cell);
    return gluing;
}

template <class Cell>
Part make_part(const Gluing<Cell>& gluing, const std::vector<double>& heights, const EdgeNumbers& numbers, size_t which,
               std::vector<bool>& edge_seen) {
    Part part;
    part.records.resize(kRecord<Cell> * gluing.cells);
    int32_t* out = part.records.data();
    for (size_t cell = 0; cell < gluing.cells; ++cell) {
        out = std::copy_n(gluing.corners.data() + Cell::kCorners * cell, Cell::kCorners, out);
        out = std::copy_n(gluing.twins.data() + Cell::kFaces * cell, Cell::kFaces, out);
        for (size_t n = 0; n < Cell::kEdges; ++n) {
            const int32_t edge = numbers(which, gluing.edges[Cell::kEdges * cell + n]);
            auto seen = edge_seen[static_cast<size_t>(edge)];
            *out++ = seen ? edge : ~edge;
            seen = true;
        }
    }
    const Skeleton skeleton = thin(gluing, heights.data());
    std::vector<std::pair<double, int32_t>> by_low(skeleton.cells.size());
    std::vector<double> highest(skeleton.cells.size());
    for (size_t n = 0; n < skeleton.cells.size(); ++n) {
        const int32_t* ids = gluing.corners.data() + Cell::kCorners * static_cast<size_t>(skeleton.cells[n]);
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
    part.classes = skeleton.classes;
    part.extrema = skeleton.extrema;
    part.bodies_and_voids = skeleton.outside_components;
    part.oddities = gluing.oddities;
    return part;
}

}  // namespace

template <class Value>
Index build(const Field<Value>& field, const Cells& cells) {
    PointNumbers points(field.size);
    const Gluing<Tet> tets = glue_in_order<Tet>(field, cells.tets, cells.tet_count, points);
    const Gluing<Hex> hexes = glue_in_order<Hex>(field, cells.hexes, cells.hex_count, points);
    std::vector<double> heights(points.points.size());
    for (size_t n = 0; n < heights.size(); ++n) heights[n] = field.height(points.points[n]);
    EdgeNumbers numbers(field.size);
    numbers.add(tets);
    numbers.add(hexes);
    numbers.merge();
    Index index;
    std::vector<bool> edge_seen(numbers.count());
    index.tets = make_part(tets, heights, numbers, 0, edge_seen);
    index.hexes = make_part(hexes, heights, numbers, 1, edge_seen);
    index.points = std::move(points.points);
    index.edge_count = numbers.count();
    return index;
}

template Index build<float>(const Field<float>&, const Cells&);
template Index build<double>(const Field<double>&, const Cells&);

}  // namespace isocore::thinning
