// size.cpp - Triangles are laid out coordinate by coordinate, so that the compiler computes several at once.
#include "surface/size.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "common/parallel.hpp"

namespace isocore {
namespace {

constexpr std::size_t kBatch = 128;
static_assert(kTrianglesPerBlock % kBatch == 0);

// Sums over triangles, kBatch at a time, each lane with sums of its own.
template <class Real>
class Batch {
  public:
    void add(const MeshView<Real>& mesh, std::size_t begin, std::size_t end, const Vec3& centre) {
        load(mesh, begin, end);
        const double cx = centre[0], cy = centre[1], cz = centre[2];
        for (std::size_t t = 0; t < kBatch; ++t) {
            const auto at = [&](std::size_t row) { return static_cast<double>(coordinates_[row][t]); };
            const double ax = at(0), ay = at(1), az = at(2);
            const double ux = at(3) - ax, uy = at(4) - ay, uz = at(5) - az;
            const double vx = at(6) - ax, vy = at(7) - ay, vz = at(8) - az;
            const double nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
            doubled_area_[t] += std::sqrt(nx * nx + ny * ny + nz * nz);
            sixfold_volume_[t] += nx * (ax - cx) + ny * (ay - cy) + nz * (az - cz);
            degenerate_[t] += std::abs(nx) + std::abs(ny) + std::abs(nz) == 0 ? 1 : 0;
        }
    }

    void add_to(Size& size) {
        size.doubled_area += sum(doubled_area_);
        size.sixfold_volume += sum(sixfold_volume_);
        size.degenerate += static_cast<std::size_t>(sum(degenerate_)) - padding_;
    }

  private:
    // A batch that is not full is filled up with triangles whose corners are all zero; padding_ counts them, since they
    // would pass for degenerate ones.
    void load(const MeshView<Real>& mesh, std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) {
            for (std::size_t corner = 0; corner < 3; ++corner) {
                const Real* vertex = mesh.vertices + 3 * static_cast<std::size_t>(mesh.triangles[3 * t + corner]);
                for (std::size_t axis = 0; axis < 3; ++axis) coordinates_[3 * corner + axis][t - begin] = vertex[axis];
            }
        }
        padding_ += kBatch - (end - begin);
        for (auto& row : coordinates_)
            std::fill(row.begin() + static_cast<std::ptrdiff_t>(end - begin), row.end(), Real{0});
    }

    // Pairwise summation: fast in vectors, and with smaller rounding errors than a running sum.
    static double sum(std::array<double, kBatch>& lanes) {
        for (std::size_t half = kBatch / 2; half > 0; half /= 2) {
            for (std::size_t i = 0; i < half; ++i) lanes[i] += lanes[i + half];
        }
        return lanes[0];
    }

    std::array<std::array<Real, kBatch>, 9> coordinates_;  // x, y, z of the first corners, then of the others
    std::array<double, kBatch> doubled_area_{};
    std::array<double, kBatch> sixfold_volume_{};
    std::array<double, kBatch> degenerate_{};
    std::size_t padding_ = 0;
};

VertexRange range_of(const std::int32_t* begin, const std::int32_t* end) {
    std::int32_t lowest = *begin, highest = *begin;
    for (const std::int32_t* corner = begin; corner != end; ++corner) {
        lowest = *corner < lowest ? *corner : lowest;
        highest = *corner > highest ? *corner : highest;
    }
    return {lowest, highest};
}

template <class Real>
struct Box {
    // Four vertices at a time, so that the compiler sees twelve independent minima.
    static constexpr std::size_t kLanes = 12;
    std::array<Real, kLanes> low, high;

    Box() {
        low.fill(std::numeric_limits<Real>::infinity());
        high.fill(-std::numeric_limits<Real>::infinity());
    }

    void add(const Real* vertices, std::size_t count) {
        std::size_t i = 0;
        for (; i + kLanes <= 3 * count; i += kLanes) {
            for (std::size_t lane = 0; lane < kLanes; ++lane) add(lane, vertices[i + lane]);
        }
        for (std::size_t lane = 0; i + lane < 3 * count; ++lane) add(lane, vertices[i + lane]);
    }

    void add(const Box& other) {
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            low[lane] = std::min(low[lane], other.low[lane]);
            high[lane] = std::max(high[lane], other.high[lane]);
        }
    }

    std::array<double, 6> corners() const {
        std::array<double, 6> found{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const Real lowest = std::min({low[axis], low[axis + 3], low[axis + 6], low[axis + 9]});
            const Real highest = std::max({high[axis], high[axis + 3], high[axis + 6], high[axis + 9]});
            if (!(lowest <= highest)) continue;
            found[axis] = static_cast<double>(lowest);
            found[axis + 3] = static_cast<double>(highest);
        }
        return found;
    }

  private:
    void add(std::size_t lane, Real x) {
        low[lane] = x < low[lane] ? x : low[lane];
        high[lane] = x > high[lane] ? x : high[lane];
    }
};

// The vertices that some triangles name. Throws if one is not there.
VertexRange checked_range(const std::int32_t* begin, const std::int32_t* end, std::size_t vertex_count) {
    const VertexRange range = range_of(begin, end);
    if (range.lowest < 0 || static_cast<std::size_t>(range.highest) >= vertex_count) {
        throw std::invalid_argument("a triangle names a vertex that does not exist");
    }
    return range;
}

}  // namespace

template <class Real>
std::array<double, 6> bounds(const Real* vertices, std::size_t count) {
    Box<Real> box;
    box.add(vertices, count);
    return box.corners();
}

template <class Real>
Size size_of(const MeshView<Real>& mesh, int threads) {
    Size total;
    if (mesh.triangle_count == 0) {
        total.bounds = bounds(mesh.vertices, mesh.vertex_count);
        return total;
    }
    // Volumes are taken around a corner of the mesh, so that a small body far from the origin keeps its digits.
    const VertexRange first_triangle = checked_range(mesh.triangles, mesh.triangles + 3, mesh.vertex_count);
    const Vec3 centre = mesh.vertex(first_triangle.lowest);
    const std::size_t count = (mesh.triangle_count + kTrianglesPerBlock - 1) / kTrianglesPerBlock;
    total.ranges.resize(count);
    std::vector<Size> blocks(count);
    std::vector<Box<Real>> boxes(count);
    parallel_for(threads, count, [&](std::size_t block) {
        const std::size_t first = block * kTrianglesPerBlock;
        const std::size_t last = std::min(mesh.triangle_count, first + kTrianglesPerBlock);
        total.ranges[block] = checked_range(mesh.triangles + 3 * first, mesh.triangles + 3 * last, mesh.vertex_count);
        Batch<Real> batch;
        for (std::size_t begin = first; begin < last; begin += kBatch) {
            batch.add(mesh, begin, std::min(last, begin + kBatch), centre);
        }
        batch.add_to(blocks[block]);
        // Its share of the vertices: in a fresh surface they are those just seen.
        const std::size_t begin = mesh.vertex_count * block / count, end = mesh.vertex_count * (block + 1) / count;
        boxes[block].add(mesh.vertices + 3 * begin, end - begin);
    });
    Box<Real> box;
    for (const Box<Real>& part : boxes) box.add(part);
    total.bounds = box.corners();
    for (const Size& block : blocks) {
        total.doubled_area += block.doubled_area;
        total.sixfold_volume += block.sixfold_volume;
        total.degenerate += block.degenerate;
    }
    return total;
}

template <class Real>
std::vector<VertexRange> ranges_of(const MeshView<Real>& mesh, int threads) {
    std::vector<VertexRange> ranges((mesh.triangle_count + kTrianglesPerBlock - 1) / kTrianglesPerBlock);
    parallel_for(threads, ranges.size(), [&](std::size_t block) {
        const std::size_t last = std::min(mesh.triangle_count, (block + 1) * kTrianglesPerBlock);
        ranges[block] = checked_range(mesh.triangles + 3 * block * kTrianglesPerBlock, mesh.triangles + 3 * last,
                                      mesh.vertex_count);
    });
    return ranges;
}

template std::array<double, 6> bounds(const float*, std::size_t);
template std::array<double, 6> bounds(const double*, std::size_t);
template Size size_of(const MeshView<float>&, int);
template Size size_of(const MeshView<double>&, int);
template std::vector<VertexRange> ranges_of(const MeshView<float>&, int);
template std::vector<VertexRange> ranges_of(const MeshView<double>&, int);

}  // namespace isocore
