#include "climbing/triangles/polygon.hpp"

#include <algorithm>
#include <bit>
#include <limits>
#include <stdexcept>

namespace isocore::climbing {
namespace {

constexpr float kIllegal = 1e30f;  // larger than any area, and so small that the sum of a few is finite

// Twice the areas of triangles.
Floats double_areas(const Vector<Floats>& a, const Vector<Floats>& b, const Vector<Floats>& c) {
    const auto normals = cross(minus(b, a), minus(c, a));
    return root(dot(normals, normals));
}

}  // namespace

void Polygon::make_room(std::size_t size) {
    const std::size_t room = size + size / 4;  // no more than that: memory grows with the square of it
    corners_.resize(room);
    stride_ = room + kLanes;
    for (auto& axis : places_) axis.assign(stride_, 0);
    area_.assign(stride_ * stride_, 0);
    apex_.resize(stride_ * stride_);
    parts_.resize(stride_);
    triangles_.resize(stride_);
}

// The places of corner `first` and of those that follow it, one in each lane.
Vector<Floats> Polygon::places(std::size_t first) const {
    return {Floats(places_[0].data() + first), Floats(places_[1].data() + first), Floats(places_[2].data() + first)};
}

Vector<Floats> Polygon::in_all_lanes(std::size_t n) const {
    return {Floats(places_[0][n]), Floats(places_[1][n]), Floats(places_[2][n])};
}

std::span<const Polygon::Triangle> Polygon::triangulate() {
    cut_ears();
    for (std::size_t span = 3; span < size_; ++span) {
        for (std::size_t i = 0; i + span < size_; ++i) find_apex(i, i + span);
    }
    constexpr float kMost = kIllegal / 2;  // not kIllegal itself, as find_apex overwrites an area's last bits
    if (!(area_[size_ - 1] < kMost)) throw std::logic_error("a loop has no legal triangulation");
    list_triangles(
        size_, [&](std::size_t i, std::size_t j) { return std::size_t{apex_[i * stride_ + j]}; }, parts_.data(),
        triangles_.data());
    return {triangles_.data(), size_ - 2};
}

void Polygon::note(std::size_t i, std::size_t j, float area, std::size_t apex) {
    area_[i * stride_ + j] = area_[j * stride_ + i] = j - i == size_ - 1 || may_join(i, j) ? area : kIllegal;
    apex_[i * stride_ + j] = static_cast<std::uint16_t>(apex);
}

// Solves the parts of two and of three corners: nothing, and one triangle (an ear).
void Polygon::cut_ears() {
    for (std::size_t i = 0; i + 1 < size_; ++i) area_[i * stride_ + i + 1] = area_[(i + 1) * stride_ + i] = 0;
    for (std::size_t first = 0; first + 2 < size_; first += kLanes) {
        const auto found = double_areas(places(first), places(first + 1), places(first + 2)).each();
        for (std::size_t i = first; i < std::min(first + kLanes, size_ - 2); ++i)
            note(i, i + 2, found[i - first], i + 1);
    }
}

// Solves part (i, j) from the solved shorter ones: tries every corner between as the apex, a lane each. The lane's
// number replaces the last bits of its area, so that the least area also tells which lane it came from.
void Polygon::find_apex(std::size_t i, std::size_t j) {
    const auto from = in_all_lanes(i), to = in_all_lanes(j);
    float best = std::numeric_limits<float>::infinity();
    std::size_t apex = i + 1;
    for (std::size_t k = i + 1; k < j; k += kLanes) {
        const Floats area = Floats(area_.data() + i * stride_ + k) + Floats(area_.data() + j * stride_ + k) +
                            double_areas(from, places(k), to);
        const float least = tagged(first_lanes(area, j - k, kIllegal)).least_lane();
        if (least < best) apex = k + std::bit_cast<std::uint32_t>(least) % kLanes;
        best = std::min(best, least);
    }
    note(i, j, best, apex);
}

}  // namespace isocore::climbing
