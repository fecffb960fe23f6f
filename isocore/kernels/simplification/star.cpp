#include "simplification/star.hpp"

#include <algorithm>

namespace isocore::simplification {

template <class Real>
void Ring::gather(const Mesh<Real>& mesh, std::int32_t vertex) {
    const Vertex& middle = mesh.vertices[static_cast<std::size_t>(vertex)];
    const auto& origin = mesh.places[static_cast<std::size_t>(vertex)].at;
    centre = vertex;
    count = middle.count;
    sheet = count > 0 ? mesh.sheet_of(middle.ring[0]) : 0;
    for (std::size_t n = 0; n < count; ++n) {
        triangles[n] = middle.ring[n];
        const Triangle& triangle = mesh.triangles[static_cast<std::size_t>(triangles[n])];
        neighbours[n] = triangle.after(triangle.index_of(vertex));
        const Spot at = mesh.relative(mesh.places[static_cast<std::size_t>(neighbours[n])].at, origin);
        for (std::size_t a = 0; a < 3; ++a) places[a][n] = at[a];
    }
    for (std::size_t a = 0; a < 3; ++a) Floats(0.0f).store(places[a].data() + count);
}

template <class Real>
void Ring::take_neighbour(const Mesh<Real>& mesh, std::size_t n, std::int32_t neighbour) {
    neighbours[n] = neighbour;
    const Spot at = mesh.relative(mesh.places[static_cast<std::size_t>(neighbour)].at,
                                  mesh.places[static_cast<std::size_t>(centre)].at);
    for (std::size_t a = 0; a < 3; ++a) places[a][n] = at[a];
}

template <class Real>
void Ring::gather_fan(const Mesh<Real>& mesh, std::int32_t vertex, std::size_t begin, std::size_t end) {
    const std::int32_t* const ring = mesh.vertices[static_cast<std::size_t>(vertex)].ring;
    centre = vertex;
    count = end - begin + 1;
    sheet = mesh.sheet_of(ring[begin]);
    for (std::size_t n = begin; n < end; ++n) {
        const Triangle& triangle = mesh.triangles[static_cast<std::size_t>(ring[n])];
        const std::size_t index = triangle.index_of(vertex);
        triangles[n - begin] = ring[n];
        take_neighbour(mesh, n - begin, triangle.after(index));
        if (n + 1 == end) take_neighbour(mesh, n + 1 - begin, triangle.after(index == 2 ? 0 : index + 1));
    }
    triangles[count - 1] = kNone;
}

template <class Real>
void Ring::gather_ends(const Mesh<Real>& mesh, std::int32_t vertex) {
    const auto ends = mesh.ends_of(vertex);
    centre = vertex;
    count = ends.size();
    for (std::size_t n = 0; n < count; ++n) take_neighbour(mesh, n, ends[n]);
    for (std::size_t a = 0; a < 3; ++a) Floats(0.0f).store(places[a].data() + count);
}

template void Ring::gather(const Mesh<float>&, std::int32_t);
template void Ring::gather(const Mesh<double>&, std::int32_t);
template void Ring::gather_fan(const Mesh<float>&, std::int32_t, std::size_t, std::size_t);
template void Ring::gather_fan(const Mesh<double>&, std::int32_t, std::size_t, std::size_t);
template void Ring::gather_ends(const Mesh<float>&, std::int32_t);
template void Ring::gather_ends(const Mesh<double>&, std::int32_t);

void Star::turn(const Ring& ring, std::size_t target) {
    centre = ring.centre;
    count = ring.count;
    sheet = ring.sheet;
    const auto rotate = [&](const auto& from, auto& to) {
        std::copy(from.begin() + target, from.begin() + count, to.begin());
        std::copy(from.begin(), from.begin() + target, to.begin() + (count - target));
    };
    rotate(ring.neighbours, neighbours);
    rotate(ring.triangles, triangles);
    for (std::size_t a = 0; a < 3; ++a) {
        rotate(ring.places[a], places[a]);
        Floats(places[a][0]).store(places[a].data() + count);  // so that lanes past the end hold no face of any kind
        Floats(places[a][0]).store(places[a].data() + count + kLanes);
    }
}

// The sum of the triangles' normals, each twice its triangle's area long: twice the area that the ring encloses.
Spot Star::doubled_area() const {
    Spot sum{0, 0, 0};
    for (std::size_t n = 0; n < count; ++n) {
        const Spot normal = cross(place(n), place(n + 1 == count ? 0 : n + 1));
        for (std::size_t a = 0; a < 3; ++a) sum[a] += normal[a];
    }
    return sum;
}

bool Star::has_good_shapes() const {
    constexpr float kCosine = 0.34f;  // of 70 degrees
    constexpr float kHeight = 0.02f;  // of the longest side
    const Spot target = place(0);
    const Vector<Floats> to{target[0], target[1], target[2]};
    const auto longest_of = [](const Vector<Floats>& a, const Vector<Floats>& b, const Vector<Floats>& c) {
        return greatest(dot(a, a), greatest(dot(b, b), dot(c, c)));  // squared
    };
    const Spot whole = doubled_area();
    const Vector<Floats> of_all{whole[0], whole[1], whole[2]};
    const Floats zero(0.0f), limit(kCosine * kCosine);
    for (std::size_t n = 1; n < count - 1; n += kLanes) {
        const auto one = in_lanes(n), other = in_lanes(n + 1);
        const auto from_one = minus(one, to), from_other = minus(other, to), side = minus(other, one);
        const auto before = cross(one, other), after = cross(from_one, from_other);
        const Floats squared = dot(after, after), old = dot(before, before);
        const Floats longest = longest_of(side, from_one, from_other), old_longest = longest_of(side, one, other);
        const Floats least_height(kHeight * kHeight);
        const auto is_turned_as = [&](const Vector<Floats>& normal) {
            const Floats cosine = dot(normal, after);
            return (zero < cosine) & (limit * dot(normal, normal) * squared <= cosine * cosine);
        };
        const auto was_sliver = old < least_height * old_longest * old_longest;
        const auto is_better = old * longest * longest < squared * old_longest * old_longest;
        const auto good = (is_turned_as(before) | (was_sliver & is_turned_as(of_all))) &
                          ((least_height * longest * longest <= squared) | is_better);
        const std::size_t faces = std::min(kLanes, count - 1 - n);
        const unsigned wanted = (1u << faces) - 1;
        if ((good.bits() & wanted) != wanted) return false;
    }
    return true;
}

void Star::draw(Facets& facets) const {
    facets.clear();
    for (std::size_t n = 1; n + 1 < count; ++n) facets.add(place(0), place(n), place(n + 1));
    facets.find_frames();
}

float Star::reach() const {
    Floats most(0.0f);
    for (std::size_t n = 0; n < count; n += kLanes) {
        const auto at = in_lanes(n);
        for (std::size_t a = 0; a < 3; ++a) most = greatest(most, greatest(at[a], Floats(0.0f) - at[a]));
    }
    return most.greatest_lane();
}

}  // namespace isocore::simplification
