#include "simplification/first_witnesses.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <tuple>
#include <vector>

#include "common/lanes.hpp"
#include "common/parallel_each.hpp"
#include "common/vectors.hpp"
#include "simplification/mesh.hpp"
#include "simplification/morton.hpp"

namespace isocore::simplification {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

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

// The squared distances from the origin to eight triangles. Follows C. Ericson, "Real-Time Collision Detection", 2005,
// section 5.1.5: which corner, side or inside is nearest; all of them are worked out, the first that holds is taken.
Floats squared_distances(const Vector<Floats>& a, const Vector<Floats>& b, const Vector<Floats>& c) {
    const Floats zero(0.0f);
    const auto ab = minus(b, a), ac = minus(c, a);
    const Floats d1 = zero - dot(ab, a), d2 = zero - dot(ac, a), d3 = zero - dot(ab, b), d4 = zero - dot(ac, b),
                 d5 = zero - dot(ab, c), d6 = zero - dot(ac, c), beyond_b = d4 - d3, beyond_c = d5 - d6;
    const auto along = [](const Vector<Floats>& from, const Vector<Floats>& way, const Floats& share) {
        const auto at = plus(from, times(share, way));
        return dot(at, at);
    };
    const Floats to_c = d1 * d4 - d3 * d2, to_b = d5 * d2 - d1 * d6, to_a = d3 * d6 - d5 * d4;
    const auto normal = cross(ab, ac);
    const Floats off = dot(normal, a);
    Floats out = off * off / dot(normal, normal);
    out = choose((to_a <= zero) & (zero <= beyond_b) & (zero <= beyond_c),
                 along(b, minus(c, b), beyond_b / (beyond_b + beyond_c)), out);
    out = choose((to_b <= zero) & (zero <= d2) & (d6 <= zero), along(a, ac, d2 / (d2 - d6)), out);
    out = choose((to_c <= zero) & (zero <= d1) & (d3 <= zero), along(a, ab, d1 / (d1 - d3)), out);
    out = choose((zero <= d6) & (d5 <= d6), dot(c, c), out);
    out = choose((zero <= d3) & (d4 <= d3), dot(b, b), out);
    return choose((d1 <= zero) & (d2 <= zero), dot(a, a), out);
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
            for (; first < end; first += kLanes) look_at(first, std::min<std::size_t>(end - first, kLanes));
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

    // Eight of the index's entries together, or as many as there are.
    void look_at(std::uint32_t first, std::size_t count) {
        std::array<std::array<float, kLanes>, 9> columns{};
        for (std::size_t n = 0; n < count; ++n) {
            const std::int32_t* const c = mesh_.triangles + 3 * triangle_of(first + n);
            for (std::size_t corner = 0; corner < 3; ++corner) {
                const Spot at = relative(mesh_.place(c[corner]), place_, stretch_);
                for (std::size_t a = 0; a < 3; ++a) columns[3 * corner + a][n] = at[a];
            }
        }
        const auto corner = [&](std::size_t n) -> Vector<Floats> {
            return {Floats(columns[3 * n].data()), Floats(columns[3 * n + 1].data()),
                    Floats(columns[3 * n + 2].data())};
        };
        const Floats squared = squared_distances(corner(0), corner(1), corner(2)), infinity(kInfinity);
        const Floats near = first_lanes(choose(squared <= Floats(best_), squared, infinity), count, infinity);
        const float least = near.least_lane();
        if (least == kInfinity) return;
        for (unsigned bits = (near <= Floats(least)).bits(); bits != 0; bits &= bits - 1) {
            const auto triangle =
                static_cast<std::int32_t>(triangle_of(first + static_cast<std::size_t>(std::countr_zero(bits))));
            if (least < best_ || (triangle != found_ && rank_of(triangle) < rank_of(found_))) {
                best_ = least;
                found_ = triangle;
            }
        }
    }

    std::size_t triangle_of(std::size_t entry) const {
        return static_cast<std::size_t>(index_.entry(static_cast<std::uint32_t>(entry)));
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
    float best_ = kInfinity;
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
