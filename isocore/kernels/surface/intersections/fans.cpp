// fans.cpp - Seen against the mean of their normals, triangles of a fan all turn the same way; so they cover what is
// around the vertex as often as they cover one direction, and once means side by side.
#include "surface/intersections/fans.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "common/parallel.hpp"
#include "surface/corners.hpp"
#include "surface/ring.hpp"
#include "surface/size.hpp"

namespace isocore::intersections {
namespace {

// What rounding may do to a product, as a share of the lengths that are multiplied: far above the some 2^-50 it does.
constexpr double kDoubt = 1.0 / (std::uint64_t{1} << 40);

// A triangle of a fan: its two edges from the vertex, and the bound on the length of their product.
struct Sector {
    Vec3 from, to, normal;
    double size;
};

double squared(const Vec3& v) { return dot(v, v); }

bool is_tidy(const Sector* fan, std::size_t count) {
    Vec3 up{};
    for (std::size_t n = 0; n < count; ++n) {
        for (std::size_t axis = 0; axis < 3; ++axis) up[axis] += fan[n].normal[axis];
    }
    const double doubt = kDoubt * (std::abs(up[0]) + std::abs(up[1]) + std::abs(up[2]));
    bool turning = true;
    for (std::size_t n = 0; n < count; ++n) turning &= dot(fan[n].normal, up) > doubt * fan[n].size;
    if (!turning) return false;
    // A direction inside the first sector; it must lie outside all others.
    Vec3 inside;
    const double to_length = std::sqrt(squared(fan[0].to)), from_length = std::sqrt(squared(fan[0].from));
    for (std::size_t axis = 0; axis < 3; ++axis)
        inside[axis] = fan[0].from[axis] * to_length + fan[0].to[axis] * from_length;
    const Vec3 across = cross(inside, up);
    const double least = doubt * std::sqrt(squared(inside));
    bool once = true;
    for (std::size_t n = 1; n < count; ++n) {
        const double from = dot(fan[n].from, across), to = dot(fan[n].to, across);
        const double slack = least * std::sqrt(fan[n].size);
        once &= from < -slack || to > slack;
    }
    return once;
}

// The fans of one window of vertices.
template <class Offset, class Real>
class Window {
  public:
    Window(const MeshView<Real>& mesh, const Corners<Offset>& corners) : mesh_(mesh), corners_(corners) {}

    bool is_tidy(std::size_t vertex) {
        const std::size_t count = corners_.count(vertex);
        if (count == 0) return true;
        fan_.clear();
        const auto self = static_cast<std::int32_t>(vertex);
        const Vec3 place = mesh_.vertex(self);
        if (is_plain_ring(corners_.slots(vertex), count)) {
            for (std::size_t n = 0; n < count; ++n) add(place, self, corners_.slots(vertex).edges[n]);
        } else {
            corners_.copy_link(vertex, link_);
            if (!is_balanced()) return false;
            for (const auto& edge : link_) add(place, self, edge);
        }
        return intersections::is_tidy(fan_.data(), fan_.size());
    }

  private:
    template <class Edge>
    void add(const Vec3& place, std::int32_t self, const Edge& edge) {
        const Vec3 from = mesh_.vertex(self + edge.from) - place, to = mesh_.vertex(self + edge.to) - place;
        fan_.push_back({from, to, cross(from, to), squared(from) + squared(to)});
    }

    // Does every edge of the link go on where another ends, so that it is made of closed rings?
    bool is_balanced() {
        starts_.clear();
        ends_.clear();
        for (const auto& edge : link_) {
            starts_.push_back(edge.from);
            ends_.push_back(edge.to);
        }
        std::sort(starts_.begin(), starts_.end());
        std::sort(ends_.begin(), ends_.end());
        return starts_ == ends_;
    }

    const MeshView<Real>& mesh_;
    const Corners<Offset>& corners_;
    std::vector<Sector> fan_;
    Link link_;
    std::vector<std::int32_t> starts_, ends_;
};

template <class Offset, class Real>
void look_around(const MeshView<Real>& mesh, const std::vector<VertexRange>& ranges, int threads,
                 Array<std::uint8_t>& tidy) {
    const std::size_t size = window_size(ranges, mesh.vertex_count, threads);
    const std::size_t count = (mesh.vertex_count + size - 1) / size;
    const auto make = [&] { return Corners<Offset>(mesh.triangles, mesh.triangle_count, ranges); };
    parallel_for(threads, count, make, [&](Corners<Offset>& corners, std::size_t n) {
        const std::size_t begin = n * size, end = std::min(mesh.vertex_count, begin + size);
        corners.look_at(begin, end);
        Window<Offset, Real> window(mesh, corners);
        for (std::size_t v = begin; v < end; ++v) tidy[v] = window.is_tidy(v);
    });
}

}  // namespace

template <class Real>
Array<std::uint8_t> tidy_fans(const MeshView<Real>& mesh, int threads) {
    const std::vector<VertexRange> ranges = ranges_of(mesh, threads);
    const auto is_short = [](VertexRange range) { return range.highest - range.lowest <= kShortRange; };
    Array<std::uint8_t> tidy(mesh.vertex_count);
    if (std::all_of(ranges.begin(), ranges.end(), is_short)) {
        look_around<std::int16_t>(mesh, ranges, threads, tidy);
    } else {
        look_around<std::int32_t>(mesh, ranges, threads, tidy);
    }
    return tidy;
}

template Array<std::uint8_t> tidy_fans(const MeshView<float>&, int);
template Array<std::uint8_t> tidy_fans(const MeshView<double>&, int);

}  // namespace isocore::intersections
