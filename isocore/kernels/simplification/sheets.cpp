// sheets.cpp - What of a mesh is about sheets: which vertices lie on the curves in which sheets meet, and which of them
// may be contracted along their curve.
#include <algorithm>
#include <array>

#include "simplification/mesh.hpp"

namespace isocore::simplification {

// A vertex inside a sheet has one ring. One on a curve has a fan of each sheet there, and all of them lie between the
// same two neighbours.
template <class Real>
void Mesh<Real>::order_fans(std::int32_t number) {
    Vertex& vertex = vertices[static_cast<std::size_t>(number)];
    if (vertex.odd) {
        vertex.is_joint = true;
        return;
    }
    std::int32_t *const begin = vertex.ring, *const end = begin + vertex.count;
    const auto is_other = [&](std::int32_t triangle) { return sheet_of(triangle) != sheet_of(*begin); };
    if (std::none_of(begin, end, is_other)) {
        order_ring(number);
        vertex.is_joint = vertex.odd = vertex.odd || vertex.open;
        return;
    }
    std::stable_sort(begin, end, [&](std::int32_t a, std::int32_t b) { return sheet_of(a) < sheet_of(b); });
    std::array<std::size_t, Vertex::kMostTriangles> ends;
    const std::size_t fans = find_fans(vertex, ends);
    std::array<std::int32_t, 2> between{};
    vertex.on_curve = true;
    for (std::size_t n = 0, first = 0; n < fans; first = ends[n++]) {
        const Fan fan = order_fan(number, begin + first, ends[n] - first);
        const auto [low, high] = std::minmax(fan.first, fan.last);
        if (n == 0) between = {low, high};
        if (fan.odd || !fan.open || between != std::array{low, high}) vertex.on_curve = false;
    }
    vertex.is_joint = vertex.odd = !vertex.on_curve;
}

template <class Real>
std::size_t Mesh<Real>::find_fans(const Vertex& vertex, std::array<std::size_t, Vertex::kMostTriangles>& ends) const {
    std::size_t count = 0;
    for (std::size_t n = 1; n <= vertex.count; ++n) {
        if (n == vertex.count || sheet_of(vertex.ring[n]) != sheet_of(vertex.ring[n - 1])) ends[count++] = n;
    }
    return count;
}

template <class Real>
std::array<std::int32_t, 2> Mesh<Real>::ends_of(std::int32_t number) const {
    const Vertex& vertex = vertices[static_cast<std::size_t>(number)];
    std::size_t last = 0;
    while (last + 1 < vertex.count && sheet_of(vertex.ring[last + 1]) == sheet_of(vertex.ring[0])) ++last;
    const Triangle& from = triangles[static_cast<std::size_t>(vertex.ring[0])];
    const Triangle& to = triangles[static_cast<std::size_t>(vertex.ring[last])];
    const std::size_t index = to.index_of(number);
    return {from.after(from.index_of(number)), to.after(index == 2 ? 0 : index + 1)};
}

template <class Real>
void Mesh<Real>::note_curves() {
    std::array<std::size_t, Vertex::kMostTriangles> ends;
    std::size_t curves = 0, witnesses = 0;
    on_curves_.clear();
    along_.clear();
    for (const Vertex& vertex : vertices) {
        if (!vertex.on_curve) continue;
        ++curves;
        witnesses += find_fans(vertex, ends);
    }
    on_curves_.reserve(curves);
    along_.reserve(curves);
    places.reserve(places.size() + witnesses);
    from_vertices.reserve(places.size() + witnesses);
    for (std::size_t v = 0; v < vertices.size(); ++v) {
        if (!vertices[v].on_curve) continue;
        on_curves_.push_back(static_cast<std::int32_t>(v));
        along_.push_back(ends_of(static_cast<std::int32_t>(v)));
    }
}

template <class Real>
void Mesh<Real>::add_curve_witnesses() {
    std::array<std::size_t, Vertex::kMostTriangles> ends;
    for (const std::int32_t v : on_curves_) {
        const auto number = static_cast<std::size_t>(v);
        const std::size_t fans = find_fans(vertices[number], ends);
        for (std::size_t n = 0; n < fans; ++n) {
            Triangle& triangle = triangles[static_cast<std::size_t>(vertices[number].ring[ends[n] - 1])];
            places.push_back({places[number].at, triangle.witness});
            from_vertices.push_back(from_vertices[number]);
            triangle.witness = static_cast<std::int32_t>(places.size() - 1);
        }
    }
}

template class Mesh<float>;
template class Mesh<double>;

}  // namespace isocore::simplification
