#include "simplification/mesh.hpp"

#include <algorithm>
#include <cstring>
#include <limits>
#include <utility>

#include "common/large_pages.hpp"
#include "common/parallel_each.hpp"
#include "simplification/morton.hpp"

namespace isocore::simplification {
std::int32_t* RingRoom::take(std::size_t size) {
    constexpr std::size_t kBlock = 16384, kTooLarge = 2;
    for (std::size_t some = size; some < std::min(size + kTooLarge, free_.size()); ++some) {
        std::int32_t* const ring = free_[some];
        if (ring == nullptr) continue;
        std::memcpy(&free_[some], ring, sizeof ring);
        return ring;
    }
    if (size > left_) {
        blocks_.push_back(std::unique_ptr<std::int32_t[]>(new std::int32_t[kBlock]));
        left_ = kBlock;
    }
    left_ -= size;
    return blocks_.back().get() + left_;
}

void RingRoom::give_back(std::int32_t* ring, std::size_t size) {
    if (size >= free_.size() || size * sizeof *ring < sizeof ring) return;
    std::memcpy(ring, &free_[size], sizeof ring);
    free_[size] = ring;
}

Quadric* QuadricRoom::take() {
    constexpr std::size_t kBlock = 1024;
    if (free_.empty()) {
        blocks_.push_back(std::make_unique<Quadric[]>(kBlock));
        for (std::size_t n = kBlock; n-- > 0;) free_.push_back(blocks_.back().get() + n);
    }
    Quadric* const out = free_.back();
    free_.pop_back();
    return out;
}

template <class Real>
Mesh<Real>::Mesh(const std::array<double, 3>& stretch, const Writing& writing)
    : stretch_{static_cast<float>(stretch[0]), static_cast<float>(stretch[1]), static_cast<float>(stretch[2])},
      writing_(writing),
      rounding_(static_cast<float>(writing.rounding * std::max({stretch[0], stretch[1], stretch[2]}))) {}

template <class Real>
void Mesh<Real>::take_all(const MeshArrays<Real>& input, const Cells& cells, int threads) {
    number_triangles(input, number_vertices(input, cells));
    find_rings(threads);
    return_freed_memory();
    quadrics.resize(vertices.size());
}

// Returns the number of each vertex of the input.
template <class Real>
Array<std::int32_t> Mesh<Real>::number_vertices(const MeshArrays<Real>& input, const Cells& cells) {
    const std::size_t count = input.vertex_count;
    std::vector<std::pair<std::uint64_t, std::int32_t>> order(count);
    for (std::size_t n = 0; n < count; ++n)
        order[n] = {morton(cells.home(input.vertices + 3 * n), kBrickBits), static_cast<std::int32_t>(n)};
    std::sort(order.begin(), order.end());
    places.resize(count);
    from_vertices.resize(count);
    Array<std::int32_t> numbers(count);
    for (std::size_t n = 0; n < count; ++n) {
        const std::int32_t from = from_vertices[n] = order[n].second;
        places[n] = {input.place(from), kNone};
        numbers[static_cast<std::size_t>(from)] = static_cast<std::int32_t>(n);
    }
    return numbers;
}

// By their lowest vertex; those of one vertex in the input's order.
template <class Real>
void Mesh<Real>::number_triangles(const MeshArrays<Real>& input, const Array<std::int32_t>& numbers) {
    const std::size_t count = input.triangle_count;
    triangles.resize(count);
    from_triangles.resize(count);
    proved.resize(count);
    std::fill(proved.begin(), proved.end(), 0.0f);  // as those of the reference
    if (input.sheets != nullptr) sheets_.resize(count);
    const auto corner = [&](std::size_t n) { return numbers[static_cast<std::size_t>(input.triangles[n])]; };
    const auto lowest = [&](std::size_t t) {
        return static_cast<std::size_t>(std::min({corner(3 * t), corner(3 * t + 1), corner(3 * t + 2)}));
    };
    std::vector<std::int32_t> next(input.vertex_count + 1);
    for (std::size_t t = 0; t < count; ++t) ++next[lowest(t) + 1];
    for (std::size_t v = 0; v < input.vertex_count; ++v) next[v + 1] += next[v];
    for (std::size_t t = 0; t < count; ++t) {
        const auto to = static_cast<std::size_t>(next[lowest(t)]++);
        triangles[to] = {{corner(3 * t), corner(3 * t + 1), corner(3 * t + 2)}, kNone};
        from_triangles[to] = static_cast<std::int32_t>(t);
        if (input.sheets != nullptr) sheets_[to] = (*input.sheets)[t];
    }
}

template <class Real>
void Mesh<Real>::find_rings(int threads) {
    vertices.resize(places.size());
    std::vector<std::uint32_t> counts(vertices.size());
    for (const Triangle& triangle : triangles) {
        for (const std::int32_t corner : triangle.corners) ++counts[static_cast<std::size_t>(corner)];
    }
    rings_.resize(3 * triangles.size());
    std::int32_t* next = rings_.data();
    for (std::size_t v = 0; v < vertices.size(); ++v) {
        vertices[v].ring = next;
        next += counts[v];
        vertices[v].odd = vertices[v].odd || counts[v] > Vertex::kMostTriangles;
        vertices[v].count = static_cast<std::uint16_t>(std::min<std::uint32_t>(counts[v], 65535));
    }
    for (std::size_t t = triangles.size(); t-- > 0;) {  // the last comes last in its rings
        for (const std::int32_t corner : triangles[t].corners) {
            const auto v = static_cast<std::size_t>(corner);
            vertices[v].ring[--counts[v]] = static_cast<std::int32_t>(t);
        }
    }
    constexpr std::size_t kAtOnce = 16384;
    parallel_each(threads, vertices.size(), kAtOnce, [&](std::size_t v) {
        if (has_sheets())
            order_fans(static_cast<std::int32_t>(v));  // sheets.cpp
        else if (!vertices[v].odd)
            order_ring(static_cast<std::int32_t>(v));
    });
    if (has_sheets()) note_curves();
}

// Puts the triangles around a vertex in the order in which they follow each other.
template <class Real>
void Mesh<Real>::order_ring(std::int32_t number) {
    Vertex& vertex = vertices[static_cast<std::size_t>(number)];
    const Fan fan = order_fan(number, vertex.ring, vertex.count);
    vertex.open = fan.open;
    vertex.odd = fan.odd;
}

template <class Real>
auto Mesh<Real>::order_fan(std::int32_t number, std::int32_t* ring, std::size_t count) const -> Fan {
    Fan out;
    std::array<std::int32_t, Vertex::kMostTriangles> from, to;  // the neighbours between which a triangle lies
    for (std::size_t n = 0; n < count; ++n) {
        const Triangle& triangle = triangles[static_cast<std::size_t>(ring[n])];
        const std::size_t index = triangle.index_of(number);
        from[n] = triangle.after(index);
        to[n] = triangle.after(index == 2 ? 0 : index + 1);
        if (from[n] == number || to[n] == number || from[n] == to[n]) out.odd = true;
    }
    const auto exchange = [&](std::size_t a, std::size_t b) {
        std::swap(ring[a], ring[b]);
        std::swap(from[a], from[b]);
        std::swap(to[a], to[b]);
    };
    for (std::size_t n = 0; n < count; ++n) {  // the first is one to which none leads, if there is such a one
        if (std::find(to.begin(), to.begin() + count, from[n]) == to.begin() + count) {
            exchange(0, n);
            out.open = true;
            break;
        }
    }
    for (std::size_t n = 1; n < count; ++n) {
        const auto found = std::find(from.begin() + n, from.begin() + count, to[n - 1]);
        if (found == from.begin() + count) {
            out.odd = true;
            return out;
        }
        exchange(n, static_cast<std::size_t>(found - from.begin()));
    }
    if (count == 0) return out;
    out.first = from[0];
    out.last = to[count - 1];
    if (!out.open && out.last != out.first) out.odd = true;
    if (out.open && std::find(from.begin(), from.begin() + count, out.last) != from.begin() + count) out.odd = true;
    return out;
}

template <class Real>
Quadric Mesh<Real>::planes_around(std::int32_t number) const {
    const Vertex& vertex = vertices[static_cast<std::size_t>(number)];
    const auto& own = places[static_cast<std::size_t>(number)].at;
    // Sums of floats depend on their order, which is that of the triangles' numbers.
    std::vector<std::int32_t> ring(vertex.ring, vertex.ring + vertex.count);
    std::sort(ring.begin(), ring.end());
    Quadric out;
    for (const std::int32_t t : ring) {
        const Triangle& triangle = triangles[static_cast<std::size_t>(t)];
        const std::size_t index = triangle.index_of(number);
        const std::int32_t next = triangle.after(index), last = triangle.after(index == 2 ? 0 : index + 1);
        out.add(relative(places[static_cast<std::size_t>(next)].at, own),
                relative(places[static_cast<std::size_t>(last)].at, own));
    }
    return out;
}

template <class Real>
void Mesh<Real>::give(const MeshArrays<Real>& input, Simplified<Real>& out) const {
    std::vector<std::int32_t> order;
    const auto sort = [&](const Array<std::int32_t>& from) {
        std::sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
            return from[static_cast<std::size_t>(a)] < from[static_cast<std::size_t>(b)];
        });
    };
    for (std::size_t v = 0; v < vertex_count(); ++v) {
        if (vertices[v].count > 0) order.push_back(static_cast<std::int32_t>(v));
    }
    sort(from_vertices);
    std::vector<std::int32_t> numbers(vertex_count());  // in out
    out.vertices.reserve(3 * order.size());
    out.kept.reserve(order.size());
    for (const std::int32_t v : order) {
        const std::int32_t from = from_vertices[static_cast<std::size_t>(v)];
        numbers[static_cast<std::size_t>(v)] = static_cast<std::int32_t>(out.kept.size());
        for (const Real at : input.place(from)) out.vertices.push_back(at);
        out.kept.push_back(from);
    }
    order.clear();
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        if (!triangles[t].is_gone()) order.push_back(static_cast<std::int32_t>(t));
    }
    sort(from_triangles);
    out.triangles.reserve(3 * order.size());
    if (has_sheets()) out.left.reserve(order.size());
    for (const std::int32_t t : order) {
        for (const std::int32_t corner : triangles[static_cast<std::size_t>(t)].corners)
            out.triangles.push_back(numbers[static_cast<std::size_t>(corner)]);
        if (has_sheets()) out.left.push_back(from_triangles[static_cast<std::size_t>(t)]);
    }
}

template class Mesh<float>;
template class Mesh<double>;

}  // namespace isocore::simplification
