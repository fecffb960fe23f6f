// distances.cpp - The tree of boxes from its top, nearer children first; those beyond the nearest triangle so far are
// left.
#include "surface/nearness/distances.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "common/parallel.hpp"
#include "surface/nearness/box_tree.hpp"
#include "surface/size.hpp"

namespace isocore {
namespace {

using nearness::Box;
using nearness::BoxTree;
using nearness::kLanes;

constexpr std::size_t kBlock = 1024;
// Boxes are of single precision, in a frame of about one: what their rounding may take from a distance.
constexpr double kSlack = 1e-6;

double squared(const Vec3& v) { return dot(v, v); }

double squared_to_segment(const Vec3& from, const Vec3& way) {
    const double length = squared(way), along = length > 0 ? std::clamp(dot(from, way) / length, 0.0, 1.0) : 0;
    Vec3 left;
    for (std::size_t axis = 0; axis < 3; ++axis) left[axis] = from[axis] - along * way[axis];
    return squared(left);
}

// To the plane where the foot lies inside the triangle, else to the nearest side.
double squared_to_triangle(const Vec3& point, const std::array<Vec3, 3>& corners) {
    const Vec3 normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
    double nearest = std::numeric_limits<double>::infinity();
    bool inside = squared(normal) > 0;
    for (std::size_t n = 0; n < 3; ++n) {
        const Vec3 way = corners[(n + 1) % 3] - corners[n], from = point - corners[n];
        inside = inside && dot(cross(normal, way), from) >= 0;
        nearest = std::min(nearest, squared_to_segment(from, way));
    }
    if (!inside) return nearest;
    const double height = dot(normal, point - corners[0]);
    return std::min(nearest, height * height / squared(normal));
}

class Finder {
  public:
    Finder(const MeshView<double>& mesh, const BoxTree& tree, const nearness::Frame& frame)
        : mesh_(mesh), tree_(tree), frame_(frame) {}

    double distance(const double* point) {
        point_ = {point[0], point[1], point[2]};
        for (std::size_t axis = 0; axis < 3; ++axis) framed_[axis] = point_[axis] * frame_.scale - frame_.centre[axis];
        nearest_ = std::numeric_limits<double>::infinity();
        descend(tree_.height(), 0);
        return std::sqrt(nearest_);
    }

  private:
    struct Child {
        double bound;
        std::size_t number;
    };

    // The square of a distance that a box's content surely has; in the mesh's own lengths.
    double least(const Box& box) const {
        double sum = 0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double below = static_cast<double>(box.low[axis]) - framed_[axis];
            const double above = framed_[axis] - static_cast<double>(box.high[axis]);
            const double apart = std::max({below, above, 0.0});
            sum += apart * apart;
        }
        const double surely = std::max(0.0, std::sqrt(sum) - kSlack) / frame_.scale;
        return surely * surely;
    }

    void descend(std::size_t level, std::size_t node) {
        std::array<Child, kLanes> children;  // nearest first
        std::size_t count = 0;
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            const Box box = tree_.boxes(level, node).at(lane);
            if (!(box.low[0] <= box.high[0])) continue;
            const double bound = least(box);
            if (!(bound < nearest_)) continue;
            std::size_t place = count++;
            for (; place > 0 && children[place - 1].bound > bound; --place) children[place] = children[place - 1];
            children[place] = {bound, kLanes * node + lane};
        }
        for (std::size_t n = 0; n < count && children[n].bound < nearest_; ++n) {
            if (level > 0) {
                descend(level - 1, children[n].number);
                continue;
            }
            const std::int32_t* corners =
                mesh_.triangles + 3 * static_cast<std::size_t>(tree_.order()[children[n].number]);
            nearest_ = std::min(
                nearest_, squared_to_triangle(
                              point_, {mesh_.vertex(corners[0]), mesh_.vertex(corners[1]), mesh_.vertex(corners[2])}));
        }
    }

    const MeshView<double>& mesh_;
    const BoxTree& tree_;
    nearness::Frame frame_;
    Vec3 point_{}, framed_{};
    double nearest_ = 0;
};

}  // namespace

Distances distances_to(const MeshView<double>& mesh, const double* points, std::size_t count, int threads) {
    check_indices(mesh.triangles, mesh.triangle_count, mesh.vertex_count);
    const nearness::Frame frame = nearness::frame_around(bounds(mesh.vertices, mesh.vertex_count));
    const BoxTree tree(mesh, frame, threads);
    if (count > 0 && tree.order().empty()) throw std::invalid_argument("there is no triangle to be near to");
    std::vector<Distances> parts((count + kBlock - 1) / kBlock);
    const auto make = [&] { return Finder(mesh, tree, frame); };
    parallel_for(threads, parts.size(), make, [&](Finder& finder, std::size_t block) {
        Distances& part = parts[block];
        for (std::size_t n = block * kBlock; n < std::min(count, (block + 1) * kBlock); ++n) {
            const double distance = finder.distance(points + 3 * n);
            part.largest = std::max(part.largest, distance);
            part.sum += distance;
            part.squares += distance * distance;
        }
    });
    Distances all;
    for (const Distances& part : parts) {
        all.largest = std::max(all.largest, part.largest);
        all.sum += part.sum;
        all.squares += part.squares;
    }
    return all;
}

}  // namespace isocore
