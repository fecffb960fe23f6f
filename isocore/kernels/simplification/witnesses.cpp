// witnesses.cpp - Which of the reference's vertices each triangle answers for when simplification begins.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "common/parallel_each.hpp"
#include "simplification/outward.hpp"

namespace isocore::simplification {
namespace {

// The reference's vertices that are not vertices of the input. Both are mostly in the same order.
template <class Real>
std::vector<std::int32_t> others(const MeshArrays<Real>& input, const MeshArrays<Real>& reference) {
    const auto at = [](const MeshArrays<Real>& mesh, std::size_t n) {
        const Real* place = mesh.vertices + 3 * n;
        return std::array<Real, 3>{place[0], place[1], place[2]};
    };
    std::vector<std::int32_t> out;
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
    Nearest(const Mesh<Real>& mesh, const TriangleGrid& grid, const std::array<Real, 3>& place)
        : mesh_(mesh), grid_(grid), place_(place) {}

    // Most are found in the cube around the place, or in those that are no further away than what was found there.
    // Else within ever more; kNone if there are no triangles.
    std::int32_t find(float limit) {
        bool is_all = look_within(0);
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

    // Looks at the cubes that are so near. Are these all?
    bool look_within(float reach) {
        const Cells& cells = grid_.cells();
        Cell low{}, high{};
        bool is_all = true;
        for (std::size_t a = 0; a < 3; ++a) {
            const double step = static_cast<double>(reach / mesh_.stretch()[a]), at = static_cast<double>(place_[a]);
            low[a] = cells.clamped(cells.in_cells(at - step, a), a) >> TriangleGrid::kBits;
            high[a] = cells.clamped(cells.in_cells(at + step, a), a) >> TriangleGrid::kBits;
            const std::size_t last = (cells.dims[a] - 1) >> TriangleGrid::kBits;
            is_all = is_all && low[a] == 0 && static_cast<std::size_t>(high[a]) == last;
        }
        const auto is_seen = [&](const Cell& cube) {
            for (std::size_t a = 0; a < 3; ++a) {
                if (cube[a] < low_[a] || cube[a] > high_[a]) return false;
            }
            return true;
        };
        for (std::int32_t k = low[2]; k <= high[2]; ++k) {
            for (std::int32_t j = low[1]; j <= high[1]; ++j) {
                for (std::int32_t i = low[0]; i <= high[0]; ++i) {
                    if (!is_seen({i, j, k}))
                        grid_.each_in(grid_.number({i, j, k}), [&](std::int32_t triangle) { look_at(triangle); });
                }
            }
        }
        low_ = low;
        high_ = high;
        return is_all;
    }

    void look_at(std::int32_t triangle) {
        const auto& c = mesh_.triangles[static_cast<std::size_t>(triangle)].corners;
        const auto corner = [&](std::size_t n) {
            return mesh_.relative(mesh_.places[static_cast<std::size_t>(c[n])].at, place_);
        };
        const Spot at = corner(0), next = corner(1), last = corner(2);
        if (squared_distance_to_box(at, next, last) > best_) return;
        const float squared = squared_distance(at, next, last);
        if (squared < best_ || (squared == best_ && triangle < found_)) {
            best_ = squared;
            found_ = triangle;
        }
    }

    const Mesh<Real>& mesh_;
    const TriangleGrid& grid_;
    const std::array<Real, 3>& place_;
    Cell low_{0, 0, 0}, high_{-1, -1, -1};  // seen already
    float best_ = std::numeric_limits<float>::infinity();
    std::int32_t found_ = kNone;
};

}  // namespace

template <class Real>
void find_witnesses(const MeshArrays<Real>& input, const MeshArrays<Real>& reference, const TriangleGrid& grid,
                    float limit, int threads, Mesh<Real>& mesh) {
    if (input.vertices == reference.vertices) return;
    const std::vector<std::int32_t> numbers = others(input, reference);
    const auto place = [&](std::size_t n) {
        const Real* at = reference.vertices + 3 * static_cast<std::size_t>(numbers[n]);
        return std::array<Real, 3>{at[0], at[1], at[2]};
    };
    std::vector<std::int32_t> triangles(numbers.size());
    constexpr std::size_t kAtOnce = 4096;
    parallel_each(threads, numbers.size(), kAtOnce, [&](std::size_t n) {
        const std::array<Real, 3> at = place(n);
        triangles[n] = Nearest<Real>(mesh, grid, at).find(limit);
    });
    // Those of one triangle follow each other in memory. Until they are there, a triangle's first witness is where its
    // next one goes.
    for (Triangle& triangle : mesh.triangles) triangle.witness = 0;
    std::size_t count = 0;
    for (const std::int32_t triangle : triangles) {
        if (triangle == kNone) continue;
        ++mesh.triangles[static_cast<std::size_t>(triangle)].witness;
        ++count;
    }
    const std::size_t first = mesh.places.size();
    auto end = static_cast<std::int32_t>(first);
    for (Triangle& triangle : mesh.triangles) end += std::exchange(triangle.witness, end);
    mesh.places.resize(first + count);
    for (std::size_t n = numbers.size(); n-- > 0;) {
        if (triangles[n] == kNone) continue;
        const std::int32_t to = mesh.triangles[static_cast<std::size_t>(triangles[n])].witness++;
        mesh.places[static_cast<std::size_t>(to)] = {place(n), to - 1};
    }
    auto begin = static_cast<std::int32_t>(first);
    for (Triangle& triangle : mesh.triangles) {
        const std::int32_t own_end = std::exchange(triangle.witness, kNone);
        if (own_end > begin) {
            mesh.places[static_cast<std::size_t>(begin)].next = kNone;
            triangle.witness = own_end - 1;
        }
        begin = own_end;
    }
}

template void find_witnesses(const MeshArrays<float>&, const MeshArrays<float>&, const TriangleGrid&, float, int,
                             Mesh<float>&);
template void find_witnesses(const MeshArrays<double>&, const MeshArrays<double>&, const TriangleGrid&, float, int,
                             Mesh<double>&);

}  // namespace isocore::simplification
