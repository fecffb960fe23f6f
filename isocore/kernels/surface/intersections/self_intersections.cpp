// self_intersections.cpp - Near pairs from a tree of boxes; those that share a corner are nearly always settled by its
// fan, and those that share none by a plane or a side between them. Exact arithmetic decides the rest.
#include "surface/intersections/self_intersections.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <vector>

#include "common/array.hpp"
#include "common/parallel.hpp"
#include "surface/intersections/corner_groups.hpp"
#include "surface/intersections/fans.hpp"
#include "surface/intersections/meeting.hpp"
#include "surface/nearness/box_tree.hpp"
#include "surface/size.hpp"

namespace isocore {
namespace {

using intersections::CornerGroup;
using intersections::Triangle;
using nearness::BoxTree;
using nearness::kLanes;

constexpr std::size_t kGroupsPerTask = 64;

std::size_t tasks(std::size_t groups) { return (groups + kGroupsPerTask - 1) / kGroupsPerTask; }

template <class Real>
std::vector<CornerGroup> corner_groups(const MeshView<Real>& mesh, const BoxTree& tree, int threads) {
    const Array<std::uint8_t> tidy = intersections::tidy_fans(mesh, threads);
    std::vector<CornerGroup> groups(tree.groups());
    parallel_for(threads, tasks(groups.size()), [&](std::size_t task) {
        const std::size_t end = std::min(tree.order().size(), kLanes * kGroupsPerTask * (task + 1));
        for (std::size_t n = kLanes * kGroupsPerTask * task; n < end; ++n) {
            const std::int32_t* corners = mesh.triangles + 3 * static_cast<std::size_t>(tree.order()[n]);
            CornerGroup& group = groups[n / kLanes];
            unsigned bits = 0;
            for (std::size_t corner = 0; corner < 3; ++corner) {
                group.vertices[corner][n % kLanes] = corners[corner];
                bits |= static_cast<unsigned>(tidy[static_cast<std::size_t>(corners[corner])]) << corner;
            }
            group.tidy[n % kLanes] = static_cast<std::uint8_t>(bits);
        }
    });
    return groups;
}

template <class Real>
class PairCounter {
  public:
    PairCounter(const MeshView<Real>& mesh, const BoxTree& tree, double scale, int threads)
        : mesh_(mesh), tree_(tree), groups_(corner_groups(mesh, tree, threads)), scale_(scale) {}

    // The pairs of a triangle of this group and a later one, of this or another group.
    std::size_t count(std::size_t group) const {
        std::size_t found = 0;
        tree_.for_each_near(group, [&](std::size_t other) {
            const auto &own = tree_.boxes(group), &theirs = tree_.boxes(other);
            std::uint32_t lanes = own.touched_by(tree_.box_of(other));
            for (; lanes != 0; lanes &= lanes - 1) {
                const auto lane = static_cast<std::size_t>(std::countr_zero(lanes));
                std::uint32_t near = theirs.touched_by(own.at(lane));
                if (other == group) near &= ~std::uint32_t{0} << lane << 1;
                if (near == 0) continue;
                const intersections::Sharing sharing = groups_[other].with(groups_[group], lane);
                near &= ~sharing.settled;
                for (; near != 0; near &= near - 1) {
                    const auto there = static_cast<std::size_t>(std::countr_zero(near));
                    found += pair_meets(kLanes * group + lane, kLanes * other + there, (sharing.any >> there & 1) != 0);
                }
            }
        });
        return found;
    }

  private:
    // The corners of a triangle by its place in the tree.
    Triangle places(std::size_t n) const {
        Triangle places;
        for (std::size_t corner = 0; corner < 3; ++corner) {
            places[corner] = mesh_.vertex(groups_[n / kLanes].vertices[corner][n % kLanes]);
            for (double& coordinate : places[corner]) coordinate *= scale_;
        }
        return places;
    }

    bool pair_meets(std::size_t one, std::size_t other, bool shares) const {
        const Triangle here = places(one), there = places(other);
        if (!shares && !intersections::meet(here, there)) return false;
        return meets_beyond_shared(here, there);
    }

    // Decides by the places of the corners alone, whatever their numbers.
    static bool meets_beyond_shared(Triangle one, Triangle other) {
        std::size_t shared = 0;
        for (std::size_t n = 0; n < 3; ++n) {
            const auto found = std::find(other.begin() + static_cast<std::ptrdiff_t>(shared), other.end(), one[n]);
            if (found == other.end()) continue;
            std::swap(*found, other[shared]);
            std::swap(one[n], one[shared]);
            ++shared;
        }
        if (shared == 1 && intersections::surely_apart_beyond_corner(one, other)) return false;
        if (!intersections::has_area(one) || !intersections::has_area(other)) return false;
        if (shared == 0) return intersections::meet(one, other);
        if (shared == 1) return intersections::meet_beyond_corner(one, other);
        return shared == 3 || intersections::meet_beyond_edge(one, other);
    }

    const MeshView<Real>& mesh_;
    const BoxTree& tree_;
    std::vector<CornerGroup> groups_;
    double scale_;
};

}  // namespace

template <class Real>
std::size_t self_intersections(const MeshView<Real>& mesh, int threads) {
    check_indices(mesh.triangles, mesh.triangle_count, mesh.vertex_count);
    const std::array<double, 6> box = bounds(mesh.vertices, mesh.vertex_count);
    const nearness::Frame frame = nearness::frame_around(box);
    const BoxTree tree(mesh, frame, threads);
    if (tree.order().empty()) return 0;
    const PairCounter<Real> counter(mesh, tree, frame.scale, threads);
    std::vector<std::size_t> found(tasks(tree.groups()));
    parallel_for(threads, found.size(), [&](std::size_t task) {
        const std::size_t end = std::min(tree.groups(), (task + 1) * kGroupsPerTask);
        for (std::size_t group = task * kGroupsPerTask; group < end; ++group) found[task] += counter.count(group);
    });
    std::size_t sum = 0;
    for (const std::size_t part : found) sum += part;
    return sum;
}

template std::size_t self_intersections(const MeshView<float>&, int);
template std::size_t self_intersections(const MeshView<double>&, int);

}  // namespace isocore
