// edge_merger.cpp - A parallel radix sort without locks: prefix sums over the counts give every run of edges its places
// in every range before it is scattered, and every range its first vertex before the vertices are written.
#include "common/edge_merger.hpp"

#include <algorithm>
#include <bit>
#include <limits>
#include <stdexcept>
#include <utility>

#include "common/parallel.hpp"

namespace isocore {
namespace {

constexpr std::size_t kEdgesPerRange = 4096, kMaxRanges = 1024, kFewEdges = 48;

struct Seen {
    std::int32_t low, high;
    std::uint32_t place;  // in the order of all edges seen
    std::int32_t vertex;  // within its range
};

// Orders a range by lower point, keeping the order of places: a counting sort, or a comparison where points are many.
void sort_by_low(Array<Seen>& range, std::int32_t first, std::size_t points) {
    const auto before = [](const Seen& a, const Seen& b) { return a.low != b.low ? a.low < b.low : a.place < b.place; };
    if (points > 16 * range.size()) return std::sort(range.begin(), range.end(), before);
    std::vector<std::uint32_t> start(points + 1);
    for (const Seen& edge : range) ++start[static_cast<std::size_t>(edge.low - first) + 1];
    for (std::size_t n = 1; n < start.size(); ++n) start[n] += start[n - 1];
    Array<Seen> sorted(range.size());
    for (const Seen& edge : range) sorted[start[static_cast<std::size_t>(edge.low - first)]++] = edge;
    range.swap(sorted);
}

// Numbers the distinct edges of a sorted range from 0 on.
Array<MeshEdge> number(Array<Seen>& range) {
    Array<MeshEdge> found;
    for (std::size_t begin = 0, end = 0; begin < range.size(); begin = end) {
        while (end < range.size() && range[end].low == range[begin].low) ++end;
        if (end - begin > kFewEdges * kFewEdges) {
            std::sort(
                range.begin() + static_cast<std::ptrdiff_t>(begin), range.begin() + static_cast<std::ptrdiff_t>(end),
                [](const Seen& a, const Seen& b) { return a.high != b.high ? a.high < b.high : a.place < b.place; });
        }
        const std::size_t first = found.size();
        for (std::size_t n = begin; n < end; ++n) {
            Seen& edge = range[n];
            if (edge.low == edge.high) {
                edge.vertex = -1;
                continue;
            }
            // From the last one back: after a sort by the higher point an equal edge, if there is one, is the last.
            std::size_t match = found.size();
            while (match > first && found[match - 1].high != edge.high && !(end - begin > kFewEdges * kFewEdges))
                --match;
            if (match > first && found[match - 1].high == edge.high) {
                edge.vertex = static_cast<std::int32_t>(match - 1);
            } else {
                edge.vertex = static_cast<std::int32_t>(found.size());
                found.push_back({edge.low, edge.high});
            }
        }
    }
    return found;
}

using Runs = std::vector<Array<MeshEdge>>;

// Which range of lower points an edge belongs to.
struct Ranges {
    std::size_t count, width;  // width: points per range

    Ranges(std::size_t edges, std::size_t points)
        : count(std::clamp<std::size_t>(std::bit_ceil(edges / kEdgesPerRange + 1), 1, kMaxRanges)),
          width(points / count + 1) {}
    std::size_t of(const MeshEdge& edge) const { return static_cast<std::size_t>(edge.low) / width; }
};

// The first step of the radix sort: the edges of every range, in the order of their places.
std::vector<Array<Seen>> scatter(const Runs& seen, const Ranges& ranges, int threads) {
    // places[run][range]: first the count, then where the run's edges go.
    std::vector<std::vector<std::uint32_t>> places(seen.size());
    parallel_for(threads, seen.size(), [&](std::size_t run) {
        places[run].resize(ranges.count);
        for (const MeshEdge& edge : seen[run]) ++places[run][ranges.of(edge)];
    });
    std::vector<Array<Seen>> sorted(ranges.count);
    for (std::size_t range = 0; range < ranges.count; ++range) {
        std::uint32_t size = 0;
        for (auto& counts : places) size += std::exchange(counts[range], size);
        sorted[range].resize(size);
    }
    std::vector<std::uint32_t> first_place(seen.size());
    for (std::size_t run = 1; run < seen.size(); ++run)
        first_place[run] = first_place[run - 1] + static_cast<std::uint32_t>(seen[run - 1].size());
    parallel_for(threads, seen.size(), [&](std::size_t run) {
        std::uint32_t place = first_place[run];
        for (const MeshEdge& edge : seen[run]) {
            const std::size_t range = ranges.of(edge);
            sorted[range][places[run][range]++] = {edge.low, edge.high, place++, 0};
        }
    });
    return sorted;
}

// Where the vertices of every range begin; and, last, how many vertices there are.
std::vector<std::size_t> first_vertices(const Runs& found) {
    std::vector<std::size_t> first(found.size() + 1);
    for (std::size_t range = 0; range < found.size(); ++range) first[range + 1] = first[range] + found[range].size();
    if (first.back() > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
        throw std::length_error("the surface has more vertices than 2^31 - 1; choose another isovalue");
    }
    return first;
}

}  // namespace

Merged merge_edges(const Runs& seen, std::size_t points, int threads) {
    std::size_t total = 0;
    for (const auto& run : seen) total += run.size();
    if (total > std::numeric_limits<std::uint32_t>::max()) throw std::length_error("the surface has too many edges");
    const Ranges ranges(total, points);
    std::vector<Array<Seen>> sorted = scatter(seen, ranges, threads);
    Runs found(ranges.count);
    parallel_for(threads, ranges.count, [&](std::size_t range) {
        sort_by_low(sorted[range], static_cast<std::int32_t>(range * ranges.width), ranges.width);
        found[range] = number(sorted[range]);
    });
    const std::vector<std::size_t> first_vertex = first_vertices(found);
    Merged merged;
    merged.edges.resize(first_vertex.back());
    merged.vertex_of.resize(total);
    parallel_for(threads, ranges.count, [&](std::size_t range) {
        const auto first = static_cast<std::int32_t>(first_vertex[range]);
        std::copy(found[range].begin(), found[range].end(), merged.edges.begin() + first);
        for (const Seen& edge : sorted[range])
            merged.vertex_of[edge.place] = edge.vertex < 0 ? -1 : first + edge.vertex;
    });
    return merged;
}

}  // namespace isocore
