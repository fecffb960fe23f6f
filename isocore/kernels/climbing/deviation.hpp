// deviation.hpp - How far marching cubes' vertices lie from our surface: each is measured in one box, against the
// triangles of that box. So the true distance is never larger.
#pragma once

#include <cmath>
#include <vector>

#include "climbing/climb.hpp"
#include "climbing/crossings.hpp"
#include "climbing/padi.hpp"
#include "climbing/polygon.hpp"
#include "climbing/vectors.hpp"

namespace isocore::climbing {

inline void add(Deviation& sum, double distance) {
    sum.max = std::max(sum.max, distance);
    sum.sum += distance;
    sum.squares += distance * distance;
}

inline void add(Deviation& sum, const Deviation& other) {
    sum.max = std::max(sum.max, other.max);
    sum.sum += other.sum;
    sum.squares += other.squares;
}

template <class Sample, class Coordinate>
class Surveyor {
  public:
    Surveyor(const GridView<Sample>& samples, const SignGrid& signs, const Layout& layout, double isovalue)
        : samples_(samples), signs_(signs), layout_(layout), isovalue_(isovalue), walk_(signs, layout) {}

    // The deviation in a disk box that is no cell, for each of the scales.
    template <std::size_t n>
    std::array<Deviation, n> survey(const HighRice& box, const std::array<Point, n>& scales) {
        walk_.loop(box, kRims[box_corners(signs_, box)], loop_);
        polygon_.corners.clear();
        for (const RimEdge& edge : loop_) polygon_.corners.push_back({place(edge.axis, edge.at), edge.faces, 0});
        triangles_.clear();
        polygon_.cut([&](std::size_t a, std::size_t b, std::size_t c) {
            triangles_.push_back({polygon_.corners[a].place, polygon_.corners[b].place, polygon_.corners[c].place});
        });
        std::array<std::int32_t, 3> last;
        for (std::size_t a = 0; a < 3; ++a) {
            last[a] = box.high[a] - (box.high[a] + 1 < static_cast<std::int32_t>(signs_.dims[a]) ? 1 : 0);
        }
        std::array<Deviation, n> out{};
        visit_crossings(signs_, box, last, [&](int axis, std::int32_t i, std::int32_t j, std::int32_t k) {
            if (layout_.is_kept(axis, static_cast<std::size_t>(i), static_cast<std::size_t>(j), static_cast<std::size_t>(k))) return;
            const Point p = place(axis, {i, j, k});
            for (std::size_t s = 0; s < n; ++s) add(out[s], distance(p, scales[s]));
        });
        return out;
    }

  private:
    double distance(const Point& p, const Point& scale) const {
        const auto scaled = [&](const Point& q) { return Point{q[0] * scale[0], q[1] * scale[1], q[2] * scale[2]}; };
        double best = std::numeric_limits<double>::infinity();
        for (const auto& [a, b, c] : triangles_) {
            best = std::min(best, squared_distance_to_triangle(scaled(p), scaled(a), scaled(b), scaled(c)));
        }
        return std::sqrt(best);
    }

    Point place(int axis, const std::array<std::int32_t, 3>& at) const {
        const auto index = [&](std::size_t a) { return static_cast<std::size_t>(at[a]); };
        Point p{static_cast<double>(at[0]), static_cast<double>(at[1]), static_cast<double>(at[2])};
        p[static_cast<std::size_t>(axis)] += edge_crossing(samples_, signs_, isovalue_, axis, index(0), index(1), index(2));
        for (double& x : p) x = static_cast<double>(static_cast<Coordinate>(x - static_cast<double>(signs_.pad)));
        return p;
    }

    const GridView<Sample>& samples_;
    const SignGrid& signs_;
    const Layout& layout_;
    double isovalue_;
    RimWalk walk_;
    std::vector<RimEdge> loop_;
    Polygon polygon_;
    std::vector<std::array<Point, 3>> triangles_;
};

}  // namespace isocore::climbing
