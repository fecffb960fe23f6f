#include "simplification/part.hpp"

#include <algorithm>
#include <bit>
#include <functional>

#include "simplification/morton.hpp"

namespace isocore::simplification {

template <class Real>
CellIndex index_by_boxes(const MeshArrays<Real>& mesh, const Cells& cells) {
    std::array<std::size_t, 3> dims;
    for (std::size_t a = 0; a < 3; ++a) dims[a] = ((cells.dims[a] - 1) >> kBoxBits) + 1;
    Array<std::uint32_t> box_of(mesh.vertex_count);
    for (std::size_t v = 0; v < mesh.vertex_count; ++v) {
        Cell box = cells.home(mesh.vertices + 3 * v);
        for (std::int32_t& at : box) at >>= kBoxBits;
        box_of[v] = static_cast<std::uint32_t>(number_of(box, dims));
    }
    const auto each_entry = [&](const auto& visit) {
        for (std::size_t t = 0; t < mesh.triangle_count; ++t) {
            const auto box = [&](std::size_t n) { return box_of[static_cast<std::size_t>(mesh.triangles[3 * t + n])]; };
            const std::uint32_t a = box(0), b = box(1), c = box(2);
            visit(static_cast<std::int32_t>(t), a);
            if (b != a) visit(static_cast<std::int32_t>(t), b);
            if (c != a && c != b) visit(static_cast<std::int32_t>(t), c);
        }
    };
    return CellIndex(dims, mesh.triangle_count, each_entry);
}

template <class Real>
void PartFinder<Real>::find(const Cell& low, const Cell& high, Part& out) {
    find_candidates(low, high);
    table_.assign(std::bit_ceil(4 * candidates_.size() + 1), kNone);
    met_.clear();
    corners_.clear();
    out.triangles.clear();
    for (const std::int32_t triangle : candidates_) {
        std::array<std::int32_t, 3> corners;
        bool touches = false;
        for (std::size_t n = 0; n < 3; ++n) {
            const std::size_t known =
                meet(whole_.mesh.triangles[3 * static_cast<std::size_t>(triangle) + n], low, high);
            corners[n] = static_cast<std::int32_t>(known);
            touches = touches || met_[known].is_own;
        }
        if (!touches) continue;
        out.triangles.push_back(triangle);
        corners_.push_back(corners);
        for (const std::int32_t corner : corners) met_[static_cast<std::size_t>(corner)].is_used = true;
    }
    number_vertices(out);
    sort_triangles(out);
}

// In their order, each once.
template <class Real>
void PartFinder<Real>::find_candidates(const Cell& low, const Cell& high) {
    candidates_.clear();
    whole_.each_run_between(low, high, [&](std::uint32_t first, std::uint32_t end) {
        for (std::uint32_t n = first; n < end; ++n) candidates_.push_back(whole_.index.entry(n));
    });
    const auto falls = std::adjacent_find(candidates_.begin(), candidates_.end(), std::greater_equal<>());
    if (falls == candidates_.end()) return;
    std::sort(candidates_.begin(), candidates_.end());
    candidates_.erase(std::unique(candidates_.begin(), candidates_.end()), candidates_.end());
}

template <class Real>
std::size_t PartFinder<Real>::meet(std::int32_t vertex, const Cell& low, const Cell& high) {
    const std::size_t mask = table_.size() - 1;
    std::size_t at = static_cast<std::uint32_t>(vertex) * 0x9e3779b1u & mask;
    for (; table_[at] != kNone; at = (at + 1) & mask) {
        const auto known = static_cast<std::size_t>(table_[at]);
        if (met_[known].number == vertex) return known;
    }
    const Cell cell = whole_.cells.home(whole_.mesh.vertices + 3 * static_cast<std::size_t>(vertex));
    bool is_own = true;
    for (std::size_t a = 0; a < 3; ++a) is_own = is_own && cell[a] >= low[a] && cell[a] <= high[a];
    const auto known = static_cast<std::int32_t>(met_.size());
    table_[at] = known;
    met_.push_back({morton(cell, kBrickBits), vertex, known, is_own, false});
    return static_cast<std::size_t>(known);
}

template <class Real>
void PartFinder<Real>::number_vertices(Part& out) {
    numbers_.assign(met_.size(), kNone);
    std::erase_if(met_, [](const Vertex& vertex) { return !vertex.is_used; });
    std::sort(met_.begin(), met_.end(), [](const Vertex& one, const Vertex& other) {
        return one.key != other.key ? one.key < other.key : one.number < other.number;
    });
    out.vertices.clear();
    out.first_own = out.end_own = 0;
    for (const Vertex& vertex : met_) {
        numbers_[static_cast<std::size_t>(vertex.known)] = static_cast<std::int32_t>(out.vertices.size());
        if (vertex.is_own && out.end_own == 0) out.first_own = out.vertices.size();
        out.vertices.push_back(vertex.number);
        if (vertex.is_own) out.end_own = out.vertices.size();
    }
    for (auto& corners : corners_) {
        for (std::int32_t& corner : corners) corner = numbers_[static_cast<std::size_t>(corner)];
    }
}

// By their lowest vertex; those of one vertex stay in their order.
template <class Real>
void PartFinder<Real>::sort_triangles(Part& out) {
    const auto lowest = [](const std::array<std::int32_t, 3>& c) {
        return static_cast<std::size_t>(std::min({c[0], c[1], c[2]}));
    };
    next_.assign(out.vertices.size() + 1, 0);
    for (const auto& corners : corners_) ++next_[lowest(corners) + 1];
    for (std::size_t v = 0; v < out.vertices.size(); ++v) next_[v + 1] += next_[v];
    out.first_numbered = static_cast<std::size_t>(next_[out.first_own]);
    candidates_.resize(corners_.size());
    out.corners.resize(corners_.size());
    for (std::size_t t = 0; t < corners_.size(); ++t) {
        const auto to = static_cast<std::size_t>(next_[lowest(corners_[t])]++);
        candidates_[to] = out.triangles[t];
        out.corners[to] = corners_[t];
    }
    out.triangles.swap(candidates_);
}

template CellIndex index_by_boxes(const MeshArrays<float>&, const Cells&);
template CellIndex index_by_boxes(const MeshArrays<double>&, const Cells&);
template class PartFinder<float>;
template class PartFinder<double>;

}  // namespace isocore::simplification
