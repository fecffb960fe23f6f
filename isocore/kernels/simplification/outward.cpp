#include "simplification/outward.hpp"

#include <algorithm>
#include <limits>

#include "common/lanes.hpp"

namespace isocore::simplification {

template <class Real>
void Witnesses::gather(const Mesh<Real>& mesh, const Ring& ring) {
    const auto& origin = mesh.places[static_cast<std::size_t>(ring.centre)].at;
    std::size_t count = 0;
    const auto add = [&](std::int32_t number) {
        if (count + kLanes >= numbers_.size()) make_room(2 * count + 16 * kLanes);
        numbers_[count] = number;
        const Spot at = mesh.relative(mesh.place_of(number), origin);
        for (std::size_t a = 0; a < 3; ++a) places_[a][count] = at[a];
        ++count;
    };
    for (std::size_t n = 0; n < ring.count; ++n) {
        if (ring.triangles[n] != kNone) mesh.fetch(mesh.triangles[static_cast<std::size_t>(ring.triangles[n])].witness);
    }
    if (!mesh.vertices[static_cast<std::size_t>(ring.centre)].on_curve) add(ring.centre);
    for (std::size_t n = 0; n < ring.count; ++n) {
        if (ring.triangles[n] == kNone) continue;
        std::int32_t witness = mesh.triangles[static_cast<std::size_t>(ring.triangles[n])].witness;
        for (; witness != kNone; witness = mesh.next(witness)) add(witness);
    }
    count_ = count;
    for (auto& axis : places_) Floats(0.0f).store(axis.data() + count);  // lanes past the end are as the centre
}

void Witnesses::make_room(std::size_t room) {
    numbers_.resize(room);
    nearest_.resize(room);
    for (auto& axis : places_) axis.resize(room);
}

bool Witnesses::are_near(const Facets& facets, float limit) {
    const Floats most(limit * limit);
    for (std::size_t n = 0; n < count_; n += kLanes) {
        const Vector<Floats> points{Floats(places_[0].data() + n), Floats(places_[1].data() + n),
                                    Floats(places_[2].data() + n)};
        Floats best(std::numeric_limits<float>::infinity()), which(0.0f);
        for (std::size_t face = 0; face < facets.size(); ++face) {
            const Floats squared = facets.from_points(face, points);
            which = choose(squared < best, Floats(static_cast<float>(face)), which);
            best = least(best, squared);
        }
        if ((most < best).any()) return false;
        which.store(nearest_.data() + n);
    }
    return true;
}

template <class Real>
void Witnesses::hand_over(Mesh<Real>& mesh, const Star& star) const {
    for (std::size_t n = 0; n < star.count; ++n) {
        if (star.triangles[n] != kNone) mesh.triangles[static_cast<std::size_t>(star.triangles[n])].witness = kNone;
    }
    for (std::size_t n = count_; n-- > 0;) {
        const std::size_t face = static_cast<std::size_t>(nearest_[n]) + 1;
        Triangle& triangle = mesh.triangles[static_cast<std::size_t>(star.triangles[face])];
        mesh.set_next(numbers_[n], triangle.witness);
        triangle.witness = numbers_[n];
    }
}

template void Witnesses::gather(const Mesh<float>&, const Ring&);
template void Witnesses::gather(const Mesh<double>&, const Ring&);
template void Witnesses::hand_over(Mesh<float>&, const Star&) const;
template void Witnesses::hand_over(Mesh<double>&, const Star&) const;

}  // namespace isocore::simplification
