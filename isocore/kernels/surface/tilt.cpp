// tilt.cpp - The criterion of T. Poston, T.-T. Wong, P.-A. Heng, "Multiresolution Isosurface Extraction with Adaptive
// Skeleton Climbing", Computer Graphics Forum 17(3), 1998, section 4, as a measure.
#include "surface/tilt.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "common/array.hpp"
#include "common/lanes.hpp"
#include "common/parallel.hpp"
#include "common/vectors.hpp"

namespace isocore {
namespace {

constexpr std::size_t kBlock = 4096;  // triangles, a multiple of kLanes
constexpr double kPart = 0.95;
constexpr std::size_t kBins = 181;  // a degree each

// What is known of one block: its angles lie together, those there are. bins: how many are of each whole degree.
struct Part {
    double sum = 0;
    float max = 0;
    std::size_t count = 0;
    std::array<std::uint32_t, kBins> bins{};
};

// The angles between unit vectors, in degrees, by half the distance of their ends: the cosine of a small angle says
// little. M. Abramowitz, I. A. Stegun, "Handbook of Mathematical Functions", 1964, 4.4.46.
Floats degrees_between(const Vector<Floats>& a, const Vector<Floats>& b) {
    constexpr std::array<float, 8> kTerms{1.5707963050f, -0.2145988016f, 0.0889789874f, -0.0501743046f,
                                          0.0308918810f, -0.0170881256f, 0.0066700901f, -0.0012624911f};
    const auto way = minus(a, b);
    const Floats one(1.0f), chord = least(root(dot(way, way)) * 0.5f, one);
    Floats sum(0.0f);
    for (std::size_t n = kTerms.size(); n-- > 0;) sum = sum * chord + kTerms[n];
    const Floats half = Floats(std::numbers::pi_v<float> / 2) - root(one - chord) * sum;
    return least(greatest(half, Floats(0.0f)) * (360 / std::numbers::pi_v<float>), Floats(180.0f));
}

// Unit normals of up to eight triangles and, corner by corner, what the field says there; NaN where there is none.
struct Eight {
    Vector<std::array<float, kLanes>> normals;
    std::array<Vector<std::array<float, kLanes>>, 3> corners;
};

template <class Real>
class Measuring {
  public:
    Measuring(const MeshView<Real>& mesh, const float* normals, const Affine& affine)
        : mesh_(mesh),
          normals_(normals),
          rows_(cofactors(affine)),
          sign_(dot(rows_[0], Vec3{affine[0], affine[1], affine[2]}) < 0 ? -1 : 1) {}

    // Writes the angles of triangles `first` to `end` - 1 to `out`, which has room for three of each.
    Part measure(std::size_t first, std::size_t end, float* out) const {
        Part part;
        Eight eight{};
        for (std::size_t t = first; t < end; t += kLanes) {
            const std::size_t count = std::min(kLanes, end - t);
            for (std::size_t n = 0; n < count; ++n) gather(t + n, n, eight);
            for (const auto& corner : eight.corners) {
                const auto found = degrees_between(in_lanes(eight.normals), in_lanes(corner)).each();
                for (std::size_t n = 0; n < count; ++n) {
                    if (std::isnan(found[n])) continue;
                    part.sum += static_cast<double>(found[n]);
                    part.max = std::max(part.max, found[n]);
                    ++part.bins[static_cast<std::size_t>(found[n])];
                    out[part.count++] = found[n];
                }
            }
        }
        return part;
    }

  private:
    static Vector<Floats> in_lanes(const Vector<std::array<float, kLanes>>& from) {
        return {Floats(from[0].data()), Floats(from[1].data()), Floats(from[2].data())};
    }

    void gather(std::size_t t, std::size_t lane, Eight& out) const {
        const std::int32_t* corners = mesh_.triangles + 3 * t;
        const Vec3 area = doubled_area(mesh_, corners);
        const Vec3 normal{dot(rows_[0], area), dot(rows_[1], area), dot(rows_[2], area)};
        const double length = sign_ * std::sqrt(dot(normal, normal));  // none: then the angles are NaN
        for (std::size_t axis = 0; axis < 3; ++axis) {
            out.normals[axis][lane] = static_cast<float>(normal[axis] / length);
            for (std::size_t n = 0; n < 3; ++n)
                out.corners[n][axis][lane] = normals_[3 * static_cast<std::size_t>(corners[n]) + axis];
        }
    }

    MeshView<Real> mesh_;
    const float* normals_;
    std::array<Vec3, 3> rows_;
    double sign_;
};

// As numpy.percentile has it: between the two angles around the place. `bins` are those of all angles, of which only
// the ones from the place's bin on are sorted out.
double quantile(const Array<float>& angles, const std::array<std::uint32_t, kBins>& bins, double part) {
    const double place = part * static_cast<double>(angles.size() - 1);
    const auto below = static_cast<std::size_t>(place);
    std::size_t before = 0, bin = 0;
    while (before + bins[bin] <= below) before += bins[bin++];
    Array<float> rest;
    rest.reserve(angles.size() - before);
    for (const float angle : angles) {
        if (angle >= static_cast<float>(bin)) rest.push_back(angle);
    }
    const auto at = rest.begin() + static_cast<std::ptrdiff_t>(below - before);
    std::nth_element(rest.begin(), at, rest.end());
    if (at + 1 == rest.end()) return static_cast<double>(*at);
    const auto low = static_cast<double>(*at), high = static_cast<double>(*std::min_element(at + 1, rest.end()));
    return low + (place - static_cast<double>(below)) * (high - low);
}

}  // namespace

template <class Real>
Tilt tilt(const MeshView<Real>& mesh, const float* normals, const Affine& affine, int threads) {
    check_indices(mesh.triangles, mesh.triangle_count, mesh.vertex_count);
    Array<float> turned(normals, normals + 3 * mesh.vertex_count);
    turn_normals(turned.data(), mesh.vertex_count, affine, threads);
    const Measuring<Real> measuring(mesh, turned.data(), affine);
    Array<float> angles(3 * mesh.triangle_count);
    std::vector<Part> parts((mesh.triangle_count + kBlock - 1) / kBlock);
    parallel_for(threads, parts.size(), [&](std::size_t n) {
        const std::size_t first = n * kBlock, end = std::min(mesh.triangle_count, first + kBlock);
        parts[n] = measuring.measure(first, end, angles.data() + 3 * first);
    });
    Tilt out;
    Part all;
    for (std::size_t n = 0; n < parts.size(); ++n) {
        const float* from = angles.data() + 3 * n * kBlock;
        std::copy(from, from + parts[n].count, angles.data() + all.count);
        all.count += parts[n].count;
        all.sum += parts[n].sum;
        all.max = std::max(all.max, parts[n].max);
        for (std::size_t bin = 0; bin < kBins; ++bin) all.bins[bin] += parts[n].bins[bin];
    }
    out.count = all.count;
    if (out.count == 0) return out;
    angles.resize(out.count);
    out.mean = all.sum / static_cast<double>(out.count);
    out.max = static_cast<double>(all.max);
    out.p95 = quantile(angles, all.bins, kPart);
    return out;
}

template Tilt tilt(const MeshView<float>&, const float*, const Affine&, int);
template Tilt tilt(const MeshView<double>&, const float*, const Affine&, int);

}  // namespace isocore
