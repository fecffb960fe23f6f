#include "climbing/triangles/polygon.hpp"

#include <algorithm>
#include <bit>
#include <limits>
#include <stdexcept>

#include "climbing/triangles/loop_cost.hpp"

namespace isocore::climbing {
namespace {

constexpr float kIllegal = 1e30f;  // larger than any cost, and so small that the sum of a few is finite

Vector<Floats> in_lanes(const Vector<std::vector<float>>& from, std::size_t first) {
    return {Floats(from[0].data() + first), Floats(from[1].data() + first), Floats(from[2].data() + first)};
}

Vector<Floats> to_all_lanes(const Vector<std::vector<float>>& from, std::size_t n) {
    return {Floats(from[0][n]), Floats(from[1][n]), Floats(from[2][n])};
}

}  // namespace

void Polygon::make_room(std::size_t size) {
    const std::size_t room = size + size / 4;  // no more than that: memory grows with the square of it
    corners_.resize(room);
    stride_ = room + kLanes;
    for (std::size_t a = 0; a < 3; ++a) {
        places_[a].assign(stride_, 0);
        directions_[a].assign(stride_, 0);
    }
    cost_.assign(stride_ * stride_, 0);
    apex_.resize(stride_ * stride_);
    parts_.resize(stride_);
    triangles_.resize(stride_);
}

// Corner `first` and those that follow it, one in each lane.
auto Polygon::corners(std::size_t first) const -> Corners {
    return {in_lanes(places_, first), in_lanes(directions_, first)};
}

auto Polygon::in_all_lanes(std::size_t n) const -> Corners {
    return {to_all_lanes(places_, n), to_all_lanes(directions_, n)};
}

// What triangles cost, one in each lane.
Floats Polygon::costs(const Corners& a, const Corners& b, const Corners& c) const {
    const auto normals = cross(minus(b.places, a.places), minus(c.places, a.places));
    if (!tilted_) return double_area(normals);
    return tilted_area(normals, plus(plus(a.directions, b.directions), c.directions));
}

std::span<const Polygon::Triangle> Polygon::triangulate(bool tilted) {
    tilted_ = tilted;
    cut_ears();
    for (std::size_t span = 3; span < size_; ++span) {
        for (std::size_t i = 0; i + span < size_; ++i) find_apex(i, i + span);
    }
    constexpr float kMost = kIllegal / 2;  // not kIllegal itself, as find_apex overwrites a cost's last bits
    if (!(cost_[size_ - 1] < kMost)) throw std::logic_error("a loop has no legal triangulation");
    list_triangles(
        size_, [&](std::size_t i, std::size_t j) { return std::size_t{apex_[i * stride_ + j]}; }, parts_.data(),
        triangles_.data());
    return {triangles_.data(), size_ - 2};
}

void Polygon::note(std::size_t i, std::size_t j, float cost, std::size_t apex) {
    cost_[i * stride_ + j] = cost_[j * stride_ + i] = j - i == size_ - 1 || may_join(i, j) ? cost : kIllegal;
    apex_[i * stride_ + j] = static_cast<std::uint16_t>(apex);
}

// Solves the parts of two and of three corners: nothing, and one triangle (an ear).
void Polygon::cut_ears() {
    for (std::size_t i = 0; i + 1 < size_; ++i) cost_[i * stride_ + i + 1] = cost_[(i + 1) * stride_ + i] = 0;
    for (std::size_t first = 0; first + 2 < size_; first += kLanes) {
        const auto found = costs(corners(first), corners(first + 1), corners(first + 2)).each();
        for (std::size_t i = first; i < std::min(first + kLanes, size_ - 2); ++i)
            note(i, i + 2, found[i - first], i + 1);
    }
}

// Solves part (i, j) from the solved shorter ones: tries every corner between as the apex, a lane each. The lane's
// number replaces the last bits of its cost, so that the least cost also tells which lane it came from.
void Polygon::find_apex(std::size_t i, std::size_t j) {
    const auto from = in_all_lanes(i), to = in_all_lanes(j);
    float best = std::numeric_limits<float>::infinity();
    std::size_t apex = i + 1;
    for (std::size_t k = i + 1; k < j; k += kLanes) {
        const Floats cost = Floats(cost_.data() + i * stride_ + k) + Floats(cost_.data() + j * stride_ + k) +
                            costs(from, corners(k), to);
        const float least = tagged(first_lanes(cost, j - k, kIllegal)).least_lane();
        if (least < best) apex = k + std::bit_cast<std::uint32_t>(least) % kLanes;
        best = std::min(best, least);
    }
    note(i, j, best, apex);
}

}  // namespace isocore::climbing
