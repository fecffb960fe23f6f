#include "simplification/triangle_grid.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace isocore::simplification {
namespace {

using Some = std::array<std::int32_t, TriangleGrid::kAtOnce>;

// Both without branches, which would often be mispredicted. How many there are:
std::size_t count_in(const Some& triangles) {
    std::size_t count = 0;
    for (const std::int32_t triangle : triangles) count += static_cast<std::size_t>(triangle != kNone);
    return count;
}

// Where one is, or their number.
std::size_t index_in(const Some& triangles, std::int32_t wanted) {
    std::size_t index = triangles.size();
    for (std::size_t n = triangles.size(); n-- > 0;) index = triangles[n] == wanted ? n : index;
    return index;
}

}  // namespace

TriangleGrid::TriangleGrid(double rounding) : rounding_(rounding), cubes_({}, rounding) {}

// Blocks are kept for what comes.
void TriangleGrid::cover(const Cells& cells, const Cell& low, const Cell& high) {
    Cells own = cells;
    for (std::size_t a = 0; a < 3; ++a) {
        own.origin[a] += low[a] / cells.per_cell;
        own.dims[a] = static_cast<std::size_t>(high[a] - low[a] + 1);
    }
    cubes_ = Cubes(own, rounding_);
    first_.resize(cubes_.count());
    std::fill(first_.begin(), first_.end(), kNone);
    spare_ = kNone;
    used_ = 0;
}

template <class Real>
void TriangleGrid::cubes_of(const Mesh<Real>& mesh, std::int32_t triangle, std::vector<std::int32_t>& out) const {
    const auto& c = mesh.triangles[static_cast<std::size_t>(triangle)].corners;
    const auto place = [&](std::size_t n) { return &mesh.places[static_cast<std::size_t>(c[n])].at; };
    cubes_.touched<Real>({place(0), place(1), place(2)}, out);
}

template <class Real>
void TriangleGrid::enter(const Mesh<Real>& mesh, std::int32_t triangle) {
    touched_.clear();
    cubes_of(mesh, triangle, touched_);
    for (const std::int32_t cube : touched_) enter_in(triangle, first_[static_cast<std::size_t>(cube)]);
}

void TriangleGrid::remove(std::int32_t triangle, const std::vector<std::int32_t>& cubes) {
    for (const std::int32_t cube : cubes) remove_from(triangle, first_[static_cast<std::size_t>(cube)]);
}

// Both are in order, so that one pass through them tells which cubes are in both, and stay as they are.
void TriangleGrid::move(std::int32_t triangle, std::span<const std::int32_t> from, std::span<const std::int32_t> to) {
    auto before = from.begin(), now = to.begin();
    while (before != from.end() || now != to.end()) {
        if (now == to.end() || (before != from.end() && *before < *now)) {
            remove_from(triangle, first_[static_cast<std::size_t>(*before++)]);
        } else if (before == from.end() || *now < *before) {
            enter_in(triangle, first_[static_cast<std::size_t>(*now++)]);
        } else {
            ++before;
            ++now;
        }
    }
}

std::int32_t TriangleGrid::take_block() {
    if (spare_ != kNone) {
        const std::int32_t taken = spare_;
        spare_ = block(taken).next;
        return taken;
    }
    if (used_ == std::numeric_limits<std::int32_t>::max())
        throw std::length_error("simplification: too many triangles in too many cells");
    if (static_cast<std::size_t>(used_) >> kChunkBits == chunks_.size())
        chunks_.push_back(std::unique_ptr<Block[]>(new Block[std::size_t{1} << kChunkBits]));
    return used_++;
}

void TriangleGrid::enter_in(std::int32_t triangle, std::int32_t& first) {
    if (first == kNone || block(first).triangles.back() != kNone) {
        const std::int32_t taken = take_block();
        block(taken).triangles.fill(kNone);
        block(taken).next = first;
        first = taken;
    }
    auto& triangles = block(first).triangles;
    triangles[count_in(triangles)] = triangle;
}

// The last triangle of the first block takes the place of the one that goes.
void TriangleGrid::remove_from(std::int32_t triangle, std::int32_t& first) {
    for (std::int32_t b = first; b != kNone; b = block(b).next) {
        auto& triangles = block(b).triangles;
        const std::size_t found = index_in(triangles, triangle);
        if (found == triangles.size()) continue;
        Block& head = block(first);
        const std::size_t last = count_in(head.triangles) - 1;
        triangles[found] = head.triangles[last];
        head.triangles[last] = kNone;
        if (last == 0) {
            const std::int32_t emptied = first;
            first = head.next;
            head.next = spare_;
            spare_ = emptied;
        }
        return;
    }
}

template void TriangleGrid::cubes_of(const Mesh<float>&, std::int32_t, std::vector<std::int32_t>&) const;
template void TriangleGrid::cubes_of(const Mesh<double>&, std::int32_t, std::vector<std::int32_t>&) const;
template void TriangleGrid::enter(const Mesh<float>&, std::int32_t);
template void TriangleGrid::enter(const Mesh<double>&, std::int32_t);

}  // namespace isocore::simplification
