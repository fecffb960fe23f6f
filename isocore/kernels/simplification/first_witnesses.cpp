#include "simplification/first_witnesses.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <vector>

#include "common/parallel_each.hpp"
#include "simplification/mesh.hpp"
#include "simplification/morton.hpp"

namespace isocore::simplification {
namespace {

// The reference's vertices that are not vertices of the input. Both are mostly in the same order.
template <class Real>
Array<std::int32_t> others(const MeshArrays<Real>& input, const MeshArrays<Real>& reference) {
    const auto at = [](const MeshArrays<Real>& mesh, std::size_t n) {
        const Real* place = mesh.vertices + 3 * n;
        return std::array<Real, 3>{place[0], place[1], place[2]};
    };
    Array<std::int32_t> out;
    out.reserve(reference.vertex_count - std::min(reference.vertex_count, input.vertex_count));
    std::size_t next = 0;
    for (std::size_t n = 0; n < reference.vertex_count; ++n) {
        if (next < input.vertex_count && at(input, next) == at(reference, n))
            ++next;
        else
            out.push_back(static_cast<std::int32_t>(n));
    }
    if (next == input.vertex_count) return out;
    std::vector<std::array<Real, 3>> known(input.vertex_count);
    for (std::size_t n = 0; n < known.size(); ++n) known[n] = at(input, n);
    std::sort(known.begin(), known.end());
    out.clear();
    for (std::size_t n = 0; n < reference.vertex_count; ++n) {
        if (!std::binary_search(known.begin(), known.end(), at(reference, n)))
            out.push_back(static_cast<std::int32_t>(n));
    }
    return out;
}

// The squared distance from the origin to a triangle. Follows C. Ericson, "Real-Time Collision Detection", 2005,
// section 5.1.5: which corner, side or inside is nearest.
float squared_distance(const Spot& a, const Spot& b, const Spot& c) {
    const Spot ab = minus(b, a), ac = minus(c, a);
    const float d1 = -dot(ab, a), d2 = -dot(ac, a), d3 = -dot(ab, b), d4 = -dot(ac, b), d5 = -dot(ab, c),
                d6 = -dot(ac, c);
    const auto along = [](const Spot& from, const Spot& way, float share) {
        const Spot at{from[0] + share * way[0], from[1] + share * way[1], from[2] + share * way[2]};
        return dot(at, at);
    };
    if (d1 <= 0 && d2 <= 0) return dot(a, a);
    if (d3 >= 0 && d4 <= d3) return dot(b, b);
    if (d6 >= 0 && d5 <= d6) return dot(c, c);
    const float to_c = d1 * d4 - d3 * d2, to_b = d5 * d2 - d1 * d6, to_a = d3 * d6 - d5 * d4;
    if (to_c <= 0 && d1 >= 0 && d3 <= 0) return along(a, ab, d1 / (d1 - d3));
    if (to_b <= 0 && d2 >= 0 && d6 <= 0) return along(a, ac, d2 / (d2 - d6));
    if (to_a <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return along(b, minus(c, b), (d4 - d3) / ((d4 - d3) + (d5 - d6)));
    const Spot normal = cross(ab, ac);
    const float off = dot(normal, a);
    return off * off / dot(normal, normal);
}

// The same to the box around it: no further.
float squared_distance_to_box(const Spot& a, const Spot& b, const Spot& c) {
    float out = 0;
    for (std::size_t n = 0; n < 3; ++n) {
        const float off =
            std::max({0.0f, std::min({a[n], b[n], c[n]}), -std::max({a[n], b[n], c[n]})});  // one is positive at most
        out += off * off;
    }
    return out;
}

// Looks for the triangle nearest to a place.
template <class Real>
class Nearest {
  public:
    Nearest(const MeshArrays<Real>& mesh, const Cells& cells, const CellIndex& index, const Spot& stretch,
            const std::array<Real, 3>& place)
        : mesh_(mesh), cells_(cells), index_(index), stretch_(stretch), place_(place) {}

    // Most are found in the cube around the place, or in those that are no further away than what was found there.
    // Else within ever more; kNone if there are no triangles.
    std::int32_t find(float limit) {
        look_in_own_cube();
        bool is_all = index_.is_one_cell();
        if (found_ != kNone && std::sqrt(best_) <= limit) {
            if (std::sqrt(best_) > std::min(kNearEnough, 0.25f * limit)) look_within(std::sqrt(best_));
            return found_;
        }
        for (float reach = std::max(limit, 1e-3f); !is_all; reach *= 2) {
            is_all = look_within(reach);
            if (found_ != kNone && std::sqrt(best_) <= reach) break;
        }
        return found_;
    }

  private:
    static constexpr float kNearEnough = 0.125f;  // cells

    void look_in_own_cube() {
        low_ = cells_.at(place_.data());
        for (std::int32_t& at : low_) at >>= Cubes::kBits;
        high_ = low_;
        look_in(low_);
    }

    void look_in(const Cell& cube) {
        index_.each_run_between(cube, cube, [&](std::uint32_t first, std::uint32_t end) {
            for (std::uint32_t n = first; n < end; ++n) look_at(index_.entry(n));
        });
    }

    // Looks at the cubes that are so near. Are these all?
    bool look_within(float reach) {
        Cell low{}, high{};
        bool is_all = true;
        for (std::size_t a = 0; a < 3; ++a) {
            const double step = static_cast<double>(reach / stretch_[a]), at = static_cast<double>(place_[a]);
            low[a] = cells_.clamped(cells_.in_cells(at - step, a), a) >> Cubes::kBits;
            high[a] = cells_.clamped(cells_.in_cells(at + step, a), a) >> Cubes::kBits;
            const std::size_t last = (cells_.dims[a] - 1) >> Cubes::kBits;
            is_all = is_all && low[a] == 0 && static_cast<std::size_t>(high[a]) == last;
        }
        if (low == low_ && high == high_) return is_all;
        const auto is_seen = [&](const Cell& cube) {
            for (std::size_t a = 0; a < 3; ++a) {
                if (cube[a] < low_[a] || cube[a] > high_[a]) return false;
            }
            return true;
        };
        each_cell_between(low, high, [&](const Cell& cube) {
            if (!is_seen(cube)) look_in(cube);
        });
        low_ = low;
        high_ = high;
        return is_all;
    }

    void look_at(std::int32_t triangle) {
        const std::int32_t* const c = mesh_.triangles + 3 * static_cast<std::size_t>(triangle);
        const auto corner = [&](std::size_t n) { return relative(mesh_.place(c[n]), place_, stretch_); };
        const Spot at = corner(0), next = corner(1), last = corner(2);
        if (squared_distance_to_box(at, next, last) > best_) return;
        const float squared = squared_distance(at, next, last);
        if (squared < best_ || (squared == best_ && rank_of(triangle) < rank_of(found_))) {
            best_ = squared;
            found_ = triangle;
        }
    }

    // Where a triangle comes in the order of a Mesh: by its lowest vertex.
    auto rank_of(std::int32_t triangle) const {
        const std::int32_t* const c = mesh_.triangles + 3 * static_cast<std::size_t>(triangle);
        const auto rank = [&](std::int32_t vertex) {
            return std::tuple(morton(cells_.home(mesh_.place(vertex).data()), kBrickBits), vertex);
        };
        return std::tuple(std::min({rank(c[0]), rank(c[1]), rank(c[2])}), triangle);
    }

    const MeshArrays<Real>& mesh_;
    const Cells& cells_;
    const CellIndex& index_;
    const Spot& stretch_;
    const std::array<Real, 3>& place_;
    Cell low_{0, 0, 0}, high_{-1, -1, -1};  // seen already
    float best_ = std::numeric_limits<float>::infinity();
    std::int32_t found_ = kNone;
};

}  // namespace

FirstWitnesses::FirstWitnesses(const Array<std::int32_t>& vertices, const Array<std::int32_t>& nearest,
                               std::size_t triangles) {
    starts_.assign(triangles + 2, 0);  // one further, until the vertices are put in
    for (const std::int32_t triangle : nearest) {
        if (triangle != kNone) ++starts_[static_cast<std::size_t>(triangle) + 2];
    }
    for (std::size_t t = 2; t < starts_.size(); ++t) starts_[t] += starts_[t - 1];
    vertices_.resize(starts_.back());
    for (std::size_t n = 0; n < vertices.size(); ++n) {
        if (nearest[n] != kNone) vertices_[starts_[static_cast<std::size_t>(nearest[n]) + 1]++] = vertices[n];
    }
    starts_.pop_back();
}

template <class Real>
CellIndex index_by_cubes(const MeshArrays<Real>& mesh, const Cubes& cubes) {
    constexpr std::size_t kUsually = 8;  // cubes of a triangle, at most
    std::vector<std::int32_t> touched;   // by each triangle in turn
    std::vector<std::size_t> ends;
    touched.reserve(kUsually * mesh.triangle_count);  // room that stays empty takes no memory
    ends.reserve(mesh.triangle_count);
    for (std::size_t t = 0; t < mesh.triangle_count; ++t) {
        const std::int32_t* const c = mesh.triangles + 3 * t;
        const std::array<std::array<Real, 3>, 3> at{mesh.place(c[0]), mesh.place(c[1]), mesh.place(c[2])};
        cubes.touched<Real>({&at[0], &at[1], &at[2]}, touched);
        ends.push_back(touched.size());
    }
    const auto each_entry = [&](const auto& visit) {
        std::size_t n = 0;
        for (std::size_t t = 0; t < ends.size(); ++t) {
            for (; n < ends[t]; ++n) visit(static_cast<std::int32_t>(t), static_cast<std::size_t>(touched[n]));
        }
    };
    return CellIndex(cubes.dims(), mesh.triangle_count, each_entry);
}

template <class Real>
FirstWitnesses find_witnesses(const MeshArrays<Real>& input, const Cubes& cubes, const CellIndex& index,
                              const MeshArrays<Real>& reference, const Spot& stretch, float limit, int threads) {
    const Array<std::int32_t> vertices = others(input, reference);
    Array<std::int32_t> nearest(vertices.size());
    constexpr std::size_t kAtOnce = 4096;
    parallel_each(threads, vertices.size(), kAtOnce, [&](std::size_t n) {
        const std::array<Real, 3> at = reference.place(vertices[n]);
        nearest[n] = Nearest<Real>(input, cubes.cells(), index, stretch, at).find(limit);
    });
    return {vertices, nearest, input.triangle_count};
}

template CellIndex index_by_cubes(const MeshArrays<float>&, const Cubes&);
template CellIndex index_by_cubes(const MeshArrays<double>&, const Cubes&);
template FirstWitnesses find_witnesses(const MeshArrays<float>&, const Cubes&, const CellIndex&,
                                       const MeshArrays<float>&, const Spot&, float, int);
template FirstWitnesses find_witnesses(const MeshArrays<double>&, const Cubes&, const CellIndex&,
                                       const MeshArrays<double>&, const Spot&, float, int);

}  // namespace isocore::simplification
