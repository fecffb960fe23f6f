// box_tree.cpp - Sorted by the interleaved bits of the places of triangles: G. M. Morton, "A Computer Oriented Geodetic
// Data Base and a New Technique in File Sequencing", IBM, 1966.
#include "surface/nearness/box_tree.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/parallel.hpp"
#include "surface/size.hpp"

namespace isocore::nearness {
namespace {

constexpr std::size_t kBlock = 8192;
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr Box kNothing{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
constexpr std::uint32_t kMortonBits = 10;  // for each axis
constexpr std::uint32_t kLeftOut = std::uint32_t{1} << 31;

void add(const Box& more, Box& box) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        box.low[axis] = std::min(box.low[axis], more.low[axis]);
        box.high[axis] = std::max(box.high[axis], more.high[axis]);
    }
}

// Not above, and not below, a coordinate: by more than its rounding.
float rounded_down(double x) {
    const auto near = static_cast<float>(x);
    return near - (std::abs(near) * std::numeric_limits<float>::epsilon() + std::numeric_limits<float>::min());
}
float rounded_up(double x) { return -rounded_down(-x); }

// Floats stay as they are. Doubles are scaled by a power of two and moved, which does not change which is the larger,
// and then rounded outwards. Nothing where a corner is not finite.
template <class Real>
Box box_around(const MeshView<Real>& mesh, const Frame& frame, std::size_t triangle) {
    Box box = kNothing;
    for (std::size_t corner = 0; corner < 3; ++corner) {
        const Real* place = mesh.vertices + 3 * static_cast<std::size_t>(mesh.triangles[3 * triangle + corner]);
        if (!std::isfinite(place[0] + place[1] + place[2])) return kNothing;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            float low, high;
            if constexpr (sizeof(Real) == sizeof(float)) {
                low = high = place[axis];
            } else {
                const double moved = place[axis] * frame.scale - frame.centre[axis];
                low = rounded_down(moved);
                high = rounded_up(moved);
            }
            box.low[axis] = low < box.low[axis] ? low : box.low[axis];
            box.high[axis] = high > box.high[axis] ? high : box.high[axis];
        }
    }
    return box;
}

bool is_nothing(const Box& box) { return box.low[0] > box.high[0]; }

// Where keys begin, and how many steps of them a length is.
struct Cube {
    std::array<float, 3> low;
    float scale;
};

// The lowest ten bits, each followed by two zeros.
std::uint32_t spread(std::uint32_t bits) {
    bits = (bits | bits << 16) & 0x030000FF;
    bits = (bits | bits << 8) & 0x0300F00F;
    bits = (bits | bits << 4) & 0x030C30C3;
    return (bits | bits << 2) & 0x09249249;
}

std::uint32_t key_of(const Box& box, const Cube& cube) {
    std::uint32_t key = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const float place = ((box.low[axis] - cube.low[axis]) + (box.high[axis] - cube.low[axis])) * 0.5F * cube.scale;
        const auto most = static_cast<float>((1U << kMortonBits) - 1);
        key |= spread(static_cast<std::uint32_t>(place > 0 ? std::min(place, most) : 0)) << axis;
    }
    return key;
}

// A triangle and the key of its place.
struct Placed {
    std::uint32_t key, triangle;
};

// By ascending key, and by number where keys are equal.
void sort(Array<Placed>& placed) {
    constexpr std::uint32_t kDigit = 11;
    Array<Placed> other(placed.size());
    for (std::uint32_t shift = 0; shift < 32; shift += kDigit) {
        std::array<std::uint32_t, (1U << kDigit) + 1> begin{};
        const auto digit = [=](Placed each) { return each.key >> shift & ((1U << kDigit) - 1); };
        for (const Placed each : placed) ++begin[digit(each) + 1];
        for (std::size_t n = 1; n < begin.size(); ++n) begin[n] += begin[n - 1];
        for (const Placed each : placed) other[begin[digit(each)]++] = each;
        placed.swap(other);
    }
}

std::vector<Boxes> empty_groups(std::size_t boxes) {
    std::vector<Boxes> groups((boxes + kLanes - 1) / kLanes);
    for (Boxes& group : groups) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            group.low[axis].fill(kInfinity);
            group.high[axis].fill(-kInfinity);
        }
    }
    return groups;
}

void put(const Box& box, std::size_t place, std::vector<Boxes>& groups) {
    Boxes& group = groups[place / kLanes];
    for (std::size_t axis = 0; axis < 3; ++axis) {
        group.low[axis][place % kLanes] = box.low[axis];
        group.high[axis][place % kLanes] = box.high[axis];
    }
}

Box joined(const Boxes& group) {
    Box box = kNothing;
    for (std::size_t lane = 0; lane < kLanes; ++lane) add(group.at(lane), box);
    return box;
}

// The cube around all vertices, in the tree's coordinates; a cube of nothing where that is not finite.
template <class Real>
Cube cube_around(const MeshView<Real>& mesh, const Frame& frame) {
    const std::array<double, 6> all = bounds(mesh.vertices, mesh.vertex_count);
    Cube cube{};
    float longest = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const bool is_float = sizeof(Real) == sizeof(float);
        const double scale = is_float ? 1 : frame.scale, centre = is_float ? 0 : frame.centre[axis];
        cube.low[axis] = static_cast<float>(all[axis] * scale - centre);
        longest = std::max(longest, static_cast<float>(all[axis + 3] * scale - centre) - cube.low[axis]);
    }
    cube.scale = longest > 0 && std::isfinite(longest) ? static_cast<float>(1U << kMortonBits) / longest : 0;
    return cube;
}

template <class Real>
Array<Placed> placed_triangles(const MeshView<Real>& mesh, const Frame& frame, int threads) {
    const Cube cube = cube_around(mesh, frame);
    Array<Placed> placed(mesh.triangle_count);
    parallel_for(threads, (mesh.triangle_count + kBlock - 1) / kBlock, [&](std::size_t block) {
        for (std::size_t t = block * kBlock; t < std::min(mesh.triangle_count, (block + 1) * kBlock); ++t) {
            const Box box = box_around(mesh, frame, t);
            placed[t] = {is_nothing(box) ? kLeftOut : key_of(box, cube), static_cast<std::uint32_t>(t)};
        }
    });
    sort(placed);
    while (!placed.empty() && placed.back().key == kLeftOut) placed.pop_back();
    return placed;
}

}  // namespace

Frame frame_around(const std::array<double, 6>& bounds) {
    double largest = 0;
    for (const double bound : bounds) {
        if (std::isfinite(bound)) largest = std::max(largest, std::abs(bound));
    }
    Frame frame{largest > 0 ? std::ldexp(1.0, std::clamp(-std::ilogb(largest), -1000, 1000)) : 1.0, {}};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double centre = (bounds[axis] * frame.scale + bounds[axis + 3] * frame.scale) / 2;
        frame.centre[axis] = std::isfinite(centre) ? centre : 0;
    }
    return frame;
}

template <class Real>
BoxTree::BoxTree(const MeshView<Real>& mesh, const Frame& frame, int threads) {
    {
        const Array<Placed> placed = placed_triangles(mesh, frame, threads);
        order_.resize(placed.size());
        for (std::size_t n = 0; n < placed.size(); ++n) order_[n] = placed[n].triangle;
    }
    levels_.push_back(empty_groups(std::max<std::size_t>(order_.size(), 1)));
    const std::size_t groups = levels_.back().size(), per_task = kBlock / kLanes;
    parallel_for(threads, (groups + per_task - 1) / per_task, [&](std::size_t task) {
        const std::size_t end = std::min(order_.size(), (task + 1) * kBlock);
        for (std::size_t n = task * kBlock; n < end; ++n) put(box_around(mesh, frame, order_[n]), n, levels_.back());
    });
    while (levels_.size() < 2 || levels_.back().size() > 1) {
        std::vector<Boxes> above = empty_groups(levels_.back().size());
        for (std::size_t n = 0; n < levels_.back().size(); ++n) put(joined(levels_.back()[n]), n, above);
        levels_.push_back(std::move(above));
    }
}

template BoxTree::BoxTree(const MeshView<float>&, const Frame&, int);
template BoxTree::BoxTree(const MeshView<double>&, const Frame&, int);

}  // namespace isocore::nearness
