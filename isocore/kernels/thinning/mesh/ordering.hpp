// ordering.hpp - Points in an order that keeps neighbours close in memory, since memory bounds both the thinning and
// the walk: along a Morton curve through their places. Cells follow their lowest points.
#pragma once

#include <cstddef>
#include <cstdint>

#include "common/array.hpp"
#include "common/mesh_field.hpp"

namespace isocore::thinning {

struct PointOrder {
    Array<std::int32_t> original;  // by new number: the mesh's
    Array<std::int32_t> number;    // by the mesh's number: the new one
};

// points: x, y, z of each of `size`. The same for any number of threads.
PointOrder order_points(const double* points, std::size_t size, int threads);

// The places and values of a field in that order.
template <class Value>
struct OrderedField {
    Array<double> points;  // x, y, z of each
    Array<Value> values;
};

// original: `size` of the field's points. Throws std::out_of_range where one is none of them.
template <class Value>
OrderedField<Value> in_order(const mesh::Field<Value>& field, const std::int32_t* original, std::size_t size,
                             int threads);

}  // namespace isocore::thinning
