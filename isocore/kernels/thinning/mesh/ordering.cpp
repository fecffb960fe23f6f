// ordering.cpp - See ordering.hpp. G. Morton, "A Computer Oriented Geodetic Data Base", IBM 1966.
#include "thinning/mesh/ordering.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>
#include <vector>

#include "common/check_numbers.hpp"
#include "common/large_pages.hpp"
#include "common/parallel.hpp"
#include "common/prefetch.hpp"

namespace isocore::thinning {
namespace {

constexpr unsigned kBits = 10;  // per axis
constexpr double kSteps = 1u << kBits;
constexpr std::size_t kChunk = std::size_t{1} << 16;

// The ten bits of a number with two zeros after each: three such numbers, shifted by 0, 1, 2, make a Morton key.
constexpr std::array<std::uint32_t, 1u << kBits> kSpread = [] {
    std::array<std::uint32_t, 1u << kBits> spread{};
    for (std::uint32_t n = 0; n < spread.size(); ++n) {
        for (unsigned bit = 0; bit < kBits; ++bit) spread[n] |= (n >> bit & 1) << 3 * bit;
    }
    return spread;
}();

// Calls work(chunk, first, end) for all chunks of that many elements.
template <class Work>
void for_chunks(int threads, std::size_t size, const Work& work) {
    parallel_for(threads, (size + kChunk - 1) / kChunk,
                 [&](std::size_t chunk) { work(chunk, chunk * kChunk, std::min(size, (chunk + 1) * kChunk)); });
}

struct Box {
    std::array<double, 3> low, high, scale;

    Box() {
        low.fill(std::numeric_limits<double>::max());
        high.fill(std::numeric_limits<double>::lowest());
    }
    void add(const double* point) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            low[axis] = std::min(low[axis], point[axis]);
            high[axis] = std::max(high[axis], point[axis]);
        }
    }
    void close() {
        for (std::size_t axis = 0; axis < 3; ++axis)
            scale[axis] = kSteps / std::max(high[axis] - low[axis], std::numeric_limits<double>::min());
    }
    // The step of an axis that a coordinate lies in, from 0 to kSteps - 1; 0 for NaN.
    std::uint32_t step(double place, std::size_t axis) const {
        const double steps = (place - low[axis]) * scale[axis];
        return steps > 0 ? static_cast<std::uint32_t>(std::min(steps, kSteps - 1)) : 0;
    }
};

Box box_around(const double* points, std::size_t size, int threads) {
    std::vector<Box> boxes((size + kChunk - 1) / kChunk);
    for_chunks(threads, size, [&](std::size_t chunk, std::size_t first, std::size_t end) {
        Box box;
        for (std::size_t n = first; n < end; ++n) box.add(points + 3 * n);
        boxes[chunk] = box;
    });
    Box all;
    for (const Box& box : boxes) {
        all.add(box.low.data());
        all.add(box.high.data());
    }
    all.close();
    return all;
}

using Keyed = std::pair<std::uint32_t, std::int32_t>;  // key, point

// One step of a radix sort: by the ten bits from `shift` on, in chunks, each of which knows where its elements go.
void sort_by_digit(const Array<Keyed>& from, Array<Keyed>& to, unsigned shift, int threads) {
    constexpr std::uint32_t kDigits = 1u << kBits;
    std::vector<std::array<std::uint32_t, kDigits>> places((from.size() + kChunk - 1) / kChunk);
    for_chunks(threads, from.size(), [&](std::size_t chunk, std::size_t first, std::size_t end) {
        for (std::size_t n = first; n < end; ++n) ++places[chunk][from[n].first >> shift & (kDigits - 1)];
    });
    std::uint32_t start = 0;
    for (std::size_t digit = 0; digit < kDigits; ++digit) {
        for (auto& of_chunk : places) start += std::exchange(of_chunk[digit], start);
    }
    for_chunks(threads, from.size(), [&](std::size_t chunk, std::size_t first, std::size_t end) {
        for (std::size_t n = first; n < end; ++n) to[places[chunk][from[n].first >> shift & (kDigits - 1)]++] = from[n];
    });
}

}  // namespace

PointOrder order_points(const double* points, std::size_t size, int threads) {
    const Box box = box_around(points, size, threads);
    Array<Keyed> order(size), other(size);
    for_chunks(threads, size, [&](std::size_t, std::size_t first, std::size_t end) {
        for (std::size_t n = first; n < end; ++n) {
            std::uint32_t key = 0;
            for (std::size_t axis = 0; axis < 3; ++axis) key |= kSpread[box.step(points[3 * n + axis], axis)] << axis;
            order[n] = {key, static_cast<std::int32_t>(n)};
        }
    });
    for (unsigned shift = 0; shift < 3 * kBits; shift += kBits) {
        sort_by_digit(order, other, shift, threads);
        order.swap(other);
    }
    PointOrder found;
    found.original.resize(size);
    found.number.resize(size);
    for_chunks(threads, size, [&](std::size_t, std::size_t first, std::size_t end) {
        for (std::size_t n = first; n < end; ++n) {
            found.original[n] = order[n].second;
            found.number[static_cast<std::size_t>(order[n].second)] = static_cast<std::int32_t>(n);
        }
    });
    return found;
}

template <class Value>
OrderedField<Value> in_order(const mesh::Field<Value>& field, const std::int32_t* original, std::size_t size,
                             int threads) {
    constexpr std::size_t kAhead = 16;
    OrderedField<Value> ordered{large_array<double>(3 * size), large_array<Value>(size)};
    for_chunks(threads, size, [&](std::size_t, std::size_t first, std::size_t end) {
        check_numbers(original + first, end - first, field.size);
        for (std::size_t n = first; n < end; ++n) {
            if (n + kAhead < end) ISOCORE_PREFETCH(field.point(original[n + kAhead]));
            std::copy_n(field.point(original[n]), 3, ordered.points.data() + 3 * n);
            ordered.values[n] = field.value(original[n]);
        }
    });
    return ordered;
}

template OrderedField<float> in_order(const mesh::Field<float>&, const std::int32_t*, std::size_t, int);
template OrderedField<double> in_order(const mesh::Field<double>&, const std::int32_t*, std::size_t, int);

}  // namespace isocore::thinning
