// renumbering.hpp - Cells and points in an order that keeps neighbours close in memory, since memory latency
// bounds both the thinning and the walk: cells along a Morton curve through their middles, points by their first cell.
#pragma once

#include <cstddef>
#include <cstdint>

#include "common/array.hpp"

namespace isocore::thinning {

// Numbers points as cells name them.
class PointNumbers {
  public:
    explicit PointNumbers(std::size_t points);
    std::int32_t operator()(std::int32_t point) {
        std::int32_t& number = number_[static_cast<std::size_t>(point)];
        if (number < 0) {
            number = static_cast<std::int32_t>(points.size());
            points.push_back(point);
        }
        return number;
    }
    Array<std::int32_t> points;  // by number; those that no cell names are missing

  private:
    Array<std::int32_t> number_;
};

// The order of cells of `corners` points each; points: x, y, z of each of `size`.
Array<std::uint32_t> morton_order(const double* points, std::size_t size, const std::int32_t* cells, std::size_t count,
                                  std::size_t corners);

}  // namespace isocore::thinning
