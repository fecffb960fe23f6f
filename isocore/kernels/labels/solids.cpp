// solids.cpp - A counting sort of triangles by label, then one label's triangles with vertices of their own.
#include "labels/solids.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

namespace isocore::labels {
namespace {

// Gives every vertex of a solid's triangles its number there: in the order in which triangles first name them.
void number_vertices(const LabelMesh& mesh, Solid& solid) {
    const auto [least, most] = std::minmax_element(solid.triangles.begin(), solid.triangles.end());
    if (least == solid.triangles.end()) return;
    const std::int32_t first = *least;
    std::vector<std::int32_t> number(static_cast<std::size_t>(*most - first) + 1, -1);
    for (std::int32_t& corner : solid.triangles) {
        std::int32_t& own = number[static_cast<std::size_t>(corner - first)];
        if (own < 0) {
            own = static_cast<std::int32_t>(solid.shared.size());
            solid.shared.push_back(corner);
        }
        corner = own;
    }
    solid.vertices.resize(3 * solid.shared.size());
    for (std::size_t n = 0; n < solid.shared.size(); ++n) {
        std::copy_n(mesh.vertices.data() + 3 * static_cast<std::size_t>(solid.shared[n]), 3,
                    solid.vertices.data() + 3 * n);
    }
}

// The triangles that one label has around one cell's middle: there are never many.
class Fans {
  public:
    // corners: of all triangles, three each. around: the numbers of those at the middle.
    Fans(std::span<std::int32_t> corners, std::span<const std::uint32_t> around, std::int32_t middle)
        : corners_(corners), around_(around), middle_(middle) {
        fan_.resize(around.size());
        std::iota(fan_.begin(), fan_.end(), std::size_t{0});
        for (std::size_t t = 0; t < fan_.size(); ++t) {
            for (std::size_t u = 0; u < t; ++u) {
                if (share_a_side(t, u)) join(t, u);
            }
        }
    }

    // Names a copy of the middle in all triangles of every fan but the first; `copy` makes one and returns its number.
    template <class Copy>
    void separate(const Copy& copy) {
        for (std::size_t t = 1; t < fan_.size(); ++t) {
            if (fan_[t] != t) continue;
            const std::int32_t own = copy();
            for (std::size_t u = t; u < fan_.size(); ++u) {
                if (fan_[u] == t) std::replace(triangle(u).begin(), triangle(u).end(), middle_, own);
            }
        }
    }

  private:
    std::span<std::int32_t, 3> triangle(std::size_t t) const { return corners_.subspan(3 * around_[t]).first<3>(); }
    bool share_a_side(std::size_t t, std::size_t u) const {
        const auto one = triangle(t), other = triangle(u);
        return std::any_of(one.begin(), one.end(), [&](std::int32_t corner) {
            return corner != middle_ && std::find(other.begin(), other.end(), corner) != other.end();
        });
    }
    void join(std::size_t t, std::size_t u) {
        const std::size_t from = std::max(fan_[t], fan_[u]), to = std::min(fan_[t], fan_[u]);
        std::replace(fan_.begin(), fan_.end(), from, to);
    }

    std::span<std::int32_t> corners_;
    std::span<const std::uint32_t> around_;
    std::int32_t middle_;
    std::vector<std::size_t> fan_;  // of each triangle: the first triangle of its fan
};

// Only the middles of cells have several fans of one label.
void separate_fans(const LabelMesh& mesh, Solid& solid) {
    std::vector<std::pair<std::int32_t, std::uint32_t>> corners;  // middles of cells, and a triangle of each
    for (std::size_t n = 0; n < solid.triangles.size(); ++n) {
        const auto shared = static_cast<std::size_t>(solid.shared[static_cast<std::size_t>(solid.triangles[n])]);
        if (free_axes(mesh.elements[shared]) == kCell)
            corners.emplace_back(solid.triangles[n], static_cast<std::uint32_t>(n / 3));
    }
    std::sort(corners.begin(), corners.end());
    std::vector<std::uint32_t> around;
    for (std::size_t begin = 0, end = 0; begin < corners.size(); begin = end) {
        const std::int32_t middle = corners[begin].first;
        around.clear();
        for (end = begin; end < corners.size() && corners[end].first == middle; ++end)
            around.push_back(corners[end].second);
        Fans fans({solid.triangles.data(), solid.triangles.size()}, around, middle);
        fans.separate([&] {
            const std::size_t own = solid.shared.size(), from = 3 * static_cast<std::size_t>(middle);
            const std::array<float, 3> place{solid.vertices[from], solid.vertices[from + 1], solid.vertices[from + 2]};
            solid.vertices.insert(solid.vertices.end(), place.begin(), place.end());
            solid.shared.push_back(solid.shared[static_cast<std::size_t>(middle)]);
            return static_cast<std::int32_t>(own);
        });
    }
}

}  // namespace

Array<std::uint32_t> neighbours(const LabelMesh& mesh) {
    // A cell's triangles follow one another, and most have the same two sides.
    std::vector<std::uint64_t> pairs;
    for (std::size_t n = 0; n < mesh.sides.size(); n += 2) {
        const std::uint64_t pair = std::uint64_t{mesh.sides[n]} << 32 | mesh.sides[n + 1];
        if (pairs.empty() || pairs.back() != pair) pairs.push_back(pair);
    }
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    Array<std::uint32_t> out;
    for (const std::uint64_t pair : pairs) {
        out.push_back(static_cast<std::uint32_t>(pair >> 32));
        out.push_back(static_cast<std::uint32_t>(pair));
    }
    return out;
}

Solids::Solids(const LabelMesh& mesh, std::size_t ranks) : sided_(mesh.sides.size()), starts_(ranks + 2, 0) {
    for (const std::uint32_t rank : mesh.sides) ++starts_[rank + 2];
    std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());
    for (std::size_t n = 0; n < mesh.sides.size(); ++n) {
        sided_[starts_[mesh.sides[n] + 1]++] = static_cast<std::uint32_t>(n);
    }
    starts_.pop_back();
}

Solid Solids::solid(const LabelMesh& mesh, std::size_t rank) const {
    if (rank + 1 >= starts_.size()) throw std::out_of_range("there is no label of this rank");
    Solid solid;
    solid.triangles.resize(3 * triangles_of(rank));
    for (std::size_t n = starts_[rank], out = 0; n < starts_[rank + 1]; ++n, out += 3) {
        const std::int32_t* corners = mesh.triangles.data() + 3 * static_cast<std::size_t>(sided_[n] >> 1);
        const bool ahead = (sided_[n] & 1) != 0;
        solid.triangles[out] = corners[0];
        solid.triangles[out + 1] = corners[ahead ? 2 : 1];
        solid.triangles[out + 2] = corners[ahead ? 1 : 2];
    }
    number_vertices(mesh, solid);
    separate_fans(mesh, solid);
    return solid;
}

}  // namespace isocore::labels
