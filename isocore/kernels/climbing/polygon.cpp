// polygon.cpp - One search for loops of all lengths, and the same without tables for those that are short, as most are.
#include "climbing/polygon.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <type_traits>
#include <utility>

namespace isocore::climbing {
namespace {

using Numbers = Lanes<float>;
constexpr float kIllegal = 1e30f;  // more than any area; a few of them are still a number

[[noreturn]] void fail() { throw std::logic_error("a loop has no legal triangulation"); }

// Twice, to be precise.
Numbers areas(const Vector<Numbers>& a, const Vector<Numbers>& b, const Vector<Numbers>& c) {
    const auto normals = cross(minus(b, a), minus(c, a));
    return root(dot(normals, normals));
}

// The bits of positive numbers are in the order of the numbers; the last three of them tell the lane, so that the
// least one tells where it is.
constexpr std::uint32_t kLaneBits = kLanes<float> - 1;
std::uint32_t tagged(float price, std::size_t lane) {
    return (std::bit_cast<std::uint32_t>(price) & ~kLaneBits) | static_cast<std::uint32_t>(lane);
}

// Calls visit with each number below n as a constant.
template <std::size_t n, class Visit>
void for_constants(const Visit& visit) {
    [&]<std::size_t... k>(std::index_sequence<k...>) { (visit(std::integral_constant<std::size_t, k>{}), ...); }(std::make_index_sequence<n>{});
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

std::span<const Polygon::Triangle> Polygon::cut() {
    switch (size_) {
        case 3: triangles_[0] = {0, 1, 2}; break;
        case 4: cut_four(); break;
        case 5: cut_short<5>(); break;
        case 6: cut_short<6>(); break;
        case 7: cut_short<7>(); break;
        case 8: cut_short<8>(); break;
        default: cut_long();
    }
    return {triangles_.data(), size_ - 2};
}

void Polygon::cut_four() {
    const auto price = [&](std::size_t a, std::size_t b, std::size_t c) {
        const Spot from = place(a), normal = cross(minus(place(b), from), minus(place(c), from));
        return std::sqrt(dot(normal, normal));
    };
    const bool may_even = may_join(0, 2), may_odd = may_join(1, 3);
    if (!(may_even | may_odd)) fail();
    const bool even_is_cheaper = price(0, 1, 2) + price(0, 2, 3) < price(0, 1, 3) + price(1, 2, 3);
    const std::size_t first = static_cast<std::size_t>(!(may_even & (!may_odd | even_is_cheaper)));
    triangles_[0] = {first, first + 1, first + 2};
    triangles_[1] = {first, first + 2, (first + 3) % 4};
}

Vector<Numbers> Polygon::places(std::size_t first) const {
    return {Numbers(places_[0].data() + first), Numbers(places_[1].data() + first), Numbers(places_[2].data() + first)};
}

Vector<Numbers> Polygon::in_all_lanes(std::size_t n) const { return {Numbers(places_[0][n]), Numbers(places_[1][n]), Numbers(places_[2][n])}; }

template <class Apex>
void Polygon::list_triangles(std::size_t n, const Apex& apex) {
    parts_[0] = {0, n - 1};
    for (std::size_t listed = 0, top = 1; listed < n - 2; ++listed) {
        const auto [i, j] = parts_[--top];
        const std::size_t k = apex(i, j);
        triangles_[listed] = {i, k, j};
        parts_[top] = {i, k};
        top += k - i > 1;
        parts_[top] = {k, j};
        top += j - k > 1;
    }
}

// What cut_long() does, with loops that the compiler unrolls: nearly all loops are as short.
template <std::size_t n>
void Polygon::cut_short() {
    std::array<std::array<float, n>, n> cost{};
    std::array<std::array<std::uint8_t, n>, n> apex;
    const auto all = places(0);
    for_constants<n - 2>([&](auto shorter) {
        constexpr std::size_t span = shorter + 2;
        for_constants<n - span>([&](auto first) {
            constexpr std::size_t i = first, j = i + span;
            const auto prices = areas(in_all_lanes(i), all, in_all_lanes(j)).each();
            std::uint32_t best = std::bit_cast<std::uint32_t>(std::numeric_limits<float>::max());
            for_constants<span - 1>([&](auto step) {
                constexpr std::size_t k = i + 1 + step;
                best = std::min(best, tagged(cost[i][k] + cost[k][j] + prices[k], k));
            });
            apex[i][j] = best & kLaneBits;
            cost[i][j] = span == n - 1 || may_join(i, j) ? std::bit_cast<float>(best) : kIllegal;
        });
    });
    if (!(cost[0][n - 1] < kIllegal)) fail();
    list_triangles(n, [&](std::size_t i, std::size_t j) { return std::size_t{apex[i][j]}; });
}

void Polygon::cut_long() {
    cut_ears();
    for (std::size_t span = 3; span < size_; ++span) {
        for (std::size_t i = 0; i + span < size_; ++i) find_apex(i, i + span);
    }
    if (!(cost_[size_ - 1] < kIllegal)) fail();
    list_triangles(size_, [&](std::size_t i, std::size_t j) { return std::size_t{apex_[i * stride_ + j]}; });
}

void Polygon::note(std::size_t i, std::size_t j, float cost, std::size_t apex) {
    cost_[i * stride_ + j] = cost_[j * stride_ + i] = j - i == size_ - 1 || may_join(i, j) ? cost : kIllegal;
    apex_[i * stride_ + j] = static_cast<std::uint16_t>(apex);
}

void Polygon::cut_ears() {
    for (std::size_t i = 0; i + 1 < size_; ++i) cost_[i * stride_ + i + 1] = cost_[(i + 1) * stride_ + i] = 0;
    for (std::size_t first = 0; first + 2 < size_; first += kLanes<float>) {
        const auto found = areas(places(first), places(first + 1), places(first + 2)).each();
        for (std::size_t i = first; i < std::min(first + kLanes<float>, size_ - 2); ++i) note(i, i + 2, found[i - first], i + 1);
    }
}

void Polygon::find_apex(std::size_t i, std::size_t j) {
    const auto from = in_all_lanes(i), to = in_all_lanes(j);
    std::uint32_t best = std::bit_cast<std::uint32_t>(std::numeric_limits<float>::max());
    std::size_t apex = i + 1;
    for (std::size_t k = i + 1; k < j; k += kLanes<float>) {
        const Numbers price = Numbers(cost_.data() + i * stride_ + k) + Numbers(cost_.data() + j * stride_ + k) + areas(from, places(k), to);
        const auto prices = choose(Numbers(kLaneNumbers<float>.data()) < static_cast<float>(j - k), price, Numbers(kIllegal)).each();
        std::uint32_t least = best;
        for (std::size_t lane = 0; lane < prices.size(); ++lane) least = std::min(least, tagged(prices[lane], lane));
        if (least < best) apex = k + (least & kLaneBits);
        best = least;
    }
    note(i, j, std::bit_cast<float>(best), apex);
}

}  // namespace isocore::climbing
