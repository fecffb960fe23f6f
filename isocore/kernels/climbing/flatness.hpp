// flatness.hpp - May a box be one piece with an error of at most max_error? All crossings in it must lie in a slab no
// thicker than that, and those on a face no further from the chord of the face's iso-line. The paper has no such test:
// its boxes are as large as simplicity allows. What this test lets through is measured afterwards all the same.
#pragma once

#include <cmath>
#include <vector>

#include "climbing/crossings.hpp"
#include "climbing/padi.hpp"
#include "climbing/partition.hpp"
#include "climbing/vectors.hpp"
#include "common/edge_vertices.hpp"

namespace isocore::climbing {

template <class Sample>
class Flatness final : public Judge {
  public:
    Flatness(const GridView<Sample>& samples, const SignGrid& signs, double isovalue, double max_error, const Point& scale)
        : samples_(samples), signs_(signs), isovalue_(isovalue), max_error_(max_error), scale_(scale) {}

    bool flat(const HighRice& box) const override {
        const Rim& rim = kRims[box_corners(signs_, box)];
        std::array<Point, 6> corners;
        for (unsigned n = 0; n < rim.length; ++n) corners[n] = place(box_crossing(signs_, box, rim.edges[n]));
        Point normal{};
        for (unsigned n = 2; n < rim.length; ++n) {
            const Point part = cross(minus(corners[n - 1], corners[0]), minus(corners[n], corners[0]));
            for (std::size_t a = 0; a < 3; ++a) normal[a] += part[a];
        }
        const double length = std::sqrt(dot(normal, normal));
        if (!(length > 0)) return false;
        double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
        bool near_chords = true;
        visit_crossings(signs_, box, box.high, [&](int axis, std::int32_t i, std::int32_t j, std::int32_t k) {
            const RimEdge edge{axis, {i, j, k}, 0};
            const Point p = place(edge);
            const double height = dot(p, normal) / length;
            lowest = std::min(lowest, height);
            highest = std::max(highest, height);
            for (unsigned n = 0; n < rim.length; ++n) {
                const std::size_t across = rim.faces[n] / 2;
                const std::int32_t side = rim.faces[n] & 1 ? box.high[across] : box.low[across];
                if (static_cast<int>(across) == axis || edge.at[across] != side) continue;
                const double off = squared_distance_to_segment(p, corners[n], corners[(n + 1) % rim.length]);
                if (off > max_error_ * max_error_) near_chords = false;
            }
        });
        return near_chords && highest - lowest <= max_error_;
    }

  private:
    Point place(const RimEdge& edge) const {
        const auto at = [&](std::size_t a) { return static_cast<std::size_t>(edge.at[a]); };
        Point p{static_cast<double>(edge.at[0]), static_cast<double>(edge.at[1]), static_cast<double>(edge.at[2])};
        p[static_cast<std::size_t>(edge.axis)] += edge_crossing(samples_, signs_, isovalue_, edge.axis, at(0), at(1), at(2));
        for (std::size_t a = 0; a < 3; ++a) p[a] *= scale_[a];
        return p;
    }

    const GridView<Sample>& samples_;
    const SignGrid& signs_;
    double isovalue_, max_error_;
    Point scale_;
};

}  // namespace isocore::climbing
