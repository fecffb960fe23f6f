#include "climbing/triangles/polygon.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <stdexcept>

namespace isocore::climbing {
namespace {

using Numbers = Lanes<float>;
constexpr float kIllegal = 1e30f;  // more than any area; a few of them are still a number

// Twice, to be precise.
Numbers areas(const Vector<Numbers>& a, const Vector<Numbers>& b, const Vector<Numbers>& c) {
    const auto normals = cross(minus(b, a), minus(c, a));
    return root(dot(normals, normals));
}

}  // namespace

void Polygon::make_room(std::size_t size) {
    const std::size_t room = size + size / 4;  // its square is what counts
    corners_.resize(room);
    stride_ = room + kLanes<float>;
    for (auto& axis : places_) axis.assign(stride_, 0);
    cost_.assign(stride_ * stride_, 0);
    apex_.resize(stride_ * stride_);
    parts_.resize(stride_);
    triangles_.resize(stride_);
}

Vector<Numbers> Polygon::places(std::size_t first) const {
    return {Numbers(places_[0].data() + first), Numbers(places_[1].data() + first), Numbers(places_[2].data() + first)};
}

Vector<Numbers> Polygon::in_all_lanes(std::size_t n) const {
    return {Numbers(places_[0][n]), Numbers(places_[1][n]), Numbers(places_[2][n])};
}

std::span<const Polygon::Triangle> Polygon::cut() {
    cut_ears();
    for (std::size_t span = 3; span < size_; ++span) {
        for (std::size_t i = 0; i + span < size_; ++i) find_apex(i, i + span);
    }
    constexpr float kMost = kIllegal / 2;  // not kIllegal itself, as a price has its lane in its last bits
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

void Polygon::cut_ears() {
    for (std::size_t i = 0; i + 1 < size_; ++i) cost_[i * stride_ + i + 1] = cost_[(i + 1) * stride_ + i] = 0;
    for (std::size_t first = 0; first + 2 < size_; first += kLanes<float>) {
        const auto found = areas(places(first), places(first + 1), places(first + 2)).each();
        for (std::size_t i = first; i < std::min(first + kLanes<float>, size_ - 2); ++i)
            note(i, i + 2, found[i - first], i + 1);
    }
}

void Polygon::find_apex(std::size_t i, std::size_t j) {
    const auto from = in_all_lanes(i), to = in_all_lanes(j);
    float best = std::numeric_limits<float>::infinity();
    std::size_t apex = i + 1;
    for (std::size_t k = i + 1; k < j; k += kLanes<float>) {
        const Numbers price = Numbers(cost_.data() + i * stride_ + k) + Numbers(cost_.data() + j * stride_ + k) +
                              areas(from, places(k), to);
        const float least = tagged(first_lanes(price, j - k, kIllegal)).least_lane();
        if (least < best) apex = k + std::bit_cast<std::uint32_t>(least) % kLanes<float>;
        best = std::min(best, least);
    }
    note(i, j, best, apex);
}

}  // namespace isocore::climbing
