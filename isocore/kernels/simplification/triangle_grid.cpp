#include "simplification/triangle_grid.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace isocore::simplification {

TriangleGrid::TriangleGrid(const Cells& cells, double rounding) : rounding_(rounding * cells.per_cell) {
    chunks_.reserve(kMostChunks);  // so that they never move while others read them
    cover(cells);
}

void TriangleGrid::cover(const Cells& cells) {
    cells_ = cells;
    for (std::size_t a = 0; a < 3; ++a) dims_[a] = ((cells.dims[a] - 1) >> kBits) + 1;
    first_.resize(dims_[0] * dims_[1] * dims_[2]);
    std::fill(first_.begin(), first_.end(), kNone);
    chunks_.clear();
}

template <class Real>
void TriangleGrid::cubes_of(std::array<const std::array<Real, 3>*, 3> corners, std::vector<std::int32_t>& out) const {
    // Rounding depends on which corner is the first: always the same one, or a triangle might be left in a cube.
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    std::array<std::array<float, 3>, 3> at;  // corners, in cubes from the low one
    Cell low{}, high{};
    for (std::size_t a = 0; a < 3; ++a) {
        std::array<double, 3> in_cells;
        for (std::size_t n = 0; n < 3; ++n) in_cells[n] = cells_.in_cells(static_cast<double>((*corners[n])[a]), a);
        const auto cube = [&](double place) { return cells_.clamped(place, a) >> kBits; };
        low[a] = cube(std::min({in_cells[0], in_cells[1], in_cells[2]}) - rounding_);
        high[a] = cube(std::max({in_cells[0], in_cells[1], in_cells[2]}) + rounding_);
        for (std::size_t n = 0; n < 3; ++n)
            at[n][a] = static_cast<float>(in_cells[n] / (1 << kBits) - static_cast<double>(low[a]));
    }
    if (low == high) return out.push_back(number(low));
    const Spot one = minus(at[1], at[0]), other = minus(at[2], at[0]), normal = cross(one, other);
    constexpr float kHalf = 0.5f + 1e-3f;  // of a cube, with some room for rounding
    float reach = kHalf * sum_of_sizes(normal);
    if (rounding_ > 0) {  // moves the plane, and turns it
        const auto moved = static_cast<float>(4 * rounding_ / (1 << kBits));
        const auto across = static_cast<float>(high[0] - low[0] + high[1] - low[1] + high[2] - low[2] + 3);
        reach += moved * (sum_of_sizes(normal) + (sum_of_sizes(one) + sum_of_sizes(other) + moved) * across);
    }
    for (std::int32_t k = low[2]; k <= high[2]; ++k) {
        const float z = normal[2] * (static_cast<float>(k - low[2]) + 0.5f - at[0][2]);
        for (std::int32_t j = low[1]; j <= high[1]; ++j) {
            const float yz = z + normal[1] * (static_cast<float>(j - low[1]) + 0.5f - at[0][1]);
            for (std::int32_t i = low[0]; i <= high[0]; ++i) {
                const float xyz = yz + normal[0] * (static_cast<float>(i - low[0]) + 0.5f - at[0][0]);
                if (!(std::abs(xyz) > reach)) out.push_back(number({i, j, k}));
            }
        }
    }
}

template <class Real>
void TriangleGrid::cubes_of(const Mesh<Real>& mesh, std::int32_t triangle, std::vector<std::int32_t>& out) const {
    const auto& c = mesh.triangles[static_cast<std::size_t>(triangle)].corners;
    const auto place = [&](std::size_t n) { return &mesh.places[static_cast<std::size_t>(c[n])].at; };
    cubes_of<Real>({place(0), place(1), place(2)}, out);
}

void TriangleGrid::add_chunk(Spare& spare) {
    const std::lock_guard<std::mutex> lock(guard_);
    if (chunks_.size() == kMostChunks) throw std::length_error("simplification: too many triangles in too many cells");
    const auto start = static_cast<std::int32_t>(chunks_.size() << kChunkBits);
    constexpr std::int32_t kBlocks = 1 << kChunkBits;
    std::unique_ptr<Block[]> chunk(new Block[kBlocks]);
    for (std::int32_t n = 0; n < kBlocks; ++n) chunk[static_cast<std::size_t>(n)].next = start + n + 1;
    chunk[kBlocks - 1].next = kNone;
    chunks_.push_back(std::move(chunk));
    spare.first = start;
}

void TriangleGrid::enter(std::int32_t triangle, std::span<const std::int32_t> cubes, Spare& spare) {
    for (const std::int32_t cube : cubes) enter(triangle, first_[static_cast<std::size_t>(cube)], spare);
}

void TriangleGrid::remove(std::int32_t triangle, const std::vector<std::int32_t>& cubes, Spare& spare) {
    for (const std::int32_t cube : cubes) remove(triangle, first_[static_cast<std::size_t>(cube)], spare);
}

// Both are in order, so that one pass through them tells which cubes are in both, and stay as they are.
void TriangleGrid::move(std::int32_t triangle, std::span<const std::int32_t> from, std::span<const std::int32_t> to,
                        Spare& spare) {
    auto before = from.begin(), now = to.begin();
    while (before != from.end() || now != to.end()) {
        if (now == to.end() || (before != from.end() && *before < *now)) {
            remove(triangle, first_[static_cast<std::size_t>(*before++)], spare);
        } else if (before == from.end() || *now < *before) {
            enter(triangle, first_[static_cast<std::size_t>(*now++)], spare);
        } else {
            ++before;
            ++now;
        }
    }
}

void TriangleGrid::enter(std::int32_t triangle, std::int32_t& first, Spare& spare) {
    if (first == kNone || block(first).triangles.back() != kNone) {
        if (spare.first == kNone) add_chunk(spare);
        const std::int32_t taken = spare.first;
        Block& own = block(taken);
        spare.first = own.next;
        own.triangles.fill(kNone);
        own.next = first;
        first = taken;
    }
    auto& triangles = block(first).triangles;
    *std::find(triangles.begin(), triangles.end(), kNone) = triangle;
}

// The last triangle of the first block takes the place of the one that goes.
void TriangleGrid::remove(std::int32_t triangle, std::int32_t& first, Spare& spare) {
    for (std::int32_t b = first; b != kNone; b = block(b).next) {
        auto& triangles = block(b).triangles;
        const auto found = std::find(triangles.begin(), triangles.end(), triangle);
        if (found == triangles.end()) continue;
        Block& head = block(first);
        auto last = std::find(head.triangles.begin(), head.triangles.end(), kNone);
        --last;
        *found = *last;
        *last = kNone;
        if (head.triangles.front() == kNone) {
            const std::int32_t emptied = first;
            first = head.next;
            head.next = spare.first;
            spare.first = emptied;
        }
        return;
    }
}

template void TriangleGrid::cubes_of(const Mesh<float>&, std::int32_t, std::vector<std::int32_t>&) const;
template void TriangleGrid::cubes_of(const Mesh<double>&, std::int32_t, std::vector<std::int32_t>&) const;
template void TriangleGrid::cubes_of(std::array<const std::array<float, 3>*, 3>, std::vector<std::int32_t>&) const;
template void TriangleGrid::cubes_of(std::array<const std::array<double, 3>*, 3>, std::vector<std::int32_t>&) const;

}  // namespace isocore::simplification
