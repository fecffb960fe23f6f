#include "surface/clusters.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <vector>

#include "surface/cell_grid.hpp"
#include "surface/components.hpp"

namespace isocore {
namespace {

constexpr double kShare = 0.92;  // of the triangles asked for: the others are room for small pieces
constexpr double kCoarser = 1.05;

std::size_t at(std::int32_t number) { return static_cast<std::size_t>(number); }

template <class Real>
class Clustering {
  public:
    Clustering(const MeshView<Real>& mesh, const CellGrid<Real>& grid)
        : mesh_(mesh), corner_count_(3 * mesh.triangle_count), cluster_of_(mesh.vertex_count) {
        join(grid);
        choose(grid);
        draw();
    }

    std::size_t triangle_count() const { return drawn_.size() / 3; }

    void keep_lone_pieces(std::size_t room);
    Clusters numbered() const;

  private:
    // Numbers the clusters: what is joined by sides inside one cell. And finds the border: the differences of its
    // neighbours, from one to the next, add up to nothing around a vertex inside.
    void join(const CellGrid<Real>& grid) {
        Array<std::uint64_t> cell_of(mesh_.vertex_count);
        for (std::size_t v = 0; v < mesh_.vertex_count; ++v) cell_of[v] = grid.cell(mesh_.vertices + 3 * v);
        Components components(mesh_.vertex_count);
        components.start(0, mesh_.vertex_count);
        around_.assign(mesh_.vertex_count, 0);
        const auto add = [&](std::int32_t vertex, std::int32_t next, std::int32_t last) {
            around_[at(vertex)] += static_cast<std::uint32_t>(last) - static_cast<std::uint32_t>(next);
            if (cell_of[at(vertex)] == cell_of[at(next)] && !components.are_close(vertex, next))
                components.join({vertex, next});
        };
        for (std::size_t n = 0; n < corner_count_; n += 3) {
            const std::int32_t* const corners = mesh_.triangles + n;
            add(corners[0], corners[1], corners[2]);
            add(corners[1], corners[2], corners[0]);
            add(corners[2], corners[0], corners[1]);
        }
        for (std::size_t v = 0; v < mesh_.vertex_count; ++v) {
            const auto vertex = static_cast<std::int32_t>(v);
            const std::int32_t root = components.root_of(vertex);
            cluster_of_[v] = root == vertex ? cluster_count_++ : cluster_of_[at(root)];
        }
    }

    bool is_on_border(std::size_t vertex) const { return around_[vertex] != 0; }

    // The vertex of each cluster that stands for it.
    void choose(const CellGrid<Real>& grid) {
        struct Cluster {
            std::array<double, 3> sum{};
            double count = 0, nearest = std::numeric_limits<double>::infinity();
            bool has_border = false;
        };
        std::vector<Cluster> clusters(at(cluster_count_));
        for (std::size_t v = 0; v < mesh_.vertex_count; ++v) {
            Cluster& cluster = clusters[at(cluster_of_[v])];
            if (is_on_border(v) != cluster.has_border) {
                if (cluster.has_border) continue;
                cluster = Cluster{};
                cluster.has_border = true;
            }
            for (std::size_t axis = 0; axis < 3; ++axis) cluster.sum[axis] += grid.share(mesh_.vertices + 3 * v, axis);
            ++cluster.count;
        }
        standing_.resize(clusters.size());
        for (std::size_t v = 0; v < mesh_.vertex_count; ++v) {
            Cluster& cluster = clusters[at(cluster_of_[v])];
            if (cluster.has_border && !is_on_border(v)) continue;
            double distance = 0;
            for (std::size_t axis = 0; axis < 3; ++axis)
                distance = std::max(
                    distance, std::abs(grid.share(mesh_.vertices + 3 * v, axis) - cluster.sum[axis] / cluster.count));
            if (distance >= cluster.nearest) continue;
            cluster.nearest = distance;
            standing_[at(cluster_of_[v])] = static_cast<std::int32_t>(v);
        }
    }

    void draw() {
        for (std::size_t n = 0; n < corner_count_; n += 3) {
            const std::int32_t a = cluster_at(n), b = cluster_at(n + 1), c = cluster_at(n + 2);
            if (a == b || b == c || c == a) continue;
            for (const std::int32_t cluster : {a, b, c}) drawn_.push_back(standing_[at(cluster)]);
        }
    }

    std::int32_t cluster_at(std::size_t corner) const { return cluster_of_[at(mesh_.triangles[corner])]; }

    const MeshView<Real>& mesh_;
    std::size_t corner_count_;
    Array<std::int32_t> cluster_of_;  // by vertex
    std::vector<std::uint32_t> around_;
    std::int32_t cluster_count_ = 0;
    Array<std::int32_t> standing_;  // by cluster: the vertex that stands for it
    Array<std::int32_t> drawn_;     // three vertices each
};

// A piece of which no triangle is drawn lies in a few clusters. Those of about the same size, up to a power of two, are
// kept together or not at all, so that they are not thinned out by the order in which they come.
template <class Real>
void Clustering<Real>::keep_lone_pieces(std::size_t room) {
    Components pieces(at(cluster_count_));
    pieces.start(0, at(cluster_count_));
    for (std::size_t n = 0; n < corner_count_; n += 3) {
        const std::int32_t a = cluster_at(n), b = cluster_at(n + 1), c = cluster_at(n + 2);
        if (!pieces.are_close(a, b)) pieces.join({a, b});
        if (!pieces.are_close(a, c)) pieces.join({a, c});
    }
    constexpr auto kDrawn = std::numeric_limits<std::size_t>::max();
    std::vector<std::size_t> sizes(at(cluster_count_));  // of lone pieces, in triangles
    for (const std::int32_t vertex : drawn_) sizes[at(pieces.root_of(cluster_of_[at(vertex)]))] = kDrawn;
    const auto size_at = [&](std::size_t corner) -> std::size_t& {
        return sizes[at(pieces.root_of(cluster_at(corner)))];
    };
    for (std::size_t n = 0; n < corner_count_; n += 3) {
        if (std::size_t& size = size_at(n); size != kDrawn) ++size;
    }
    constexpr auto kSizes = static_cast<std::size_t>(std::numeric_limits<std::size_t>::digits);
    const auto order = [](std::size_t size) { return static_cast<std::size_t>(std::bit_width(size)); };
    std::array<std::size_t, kSizes> together{};  // triangles of all pieces of a size
    for (const std::size_t size : sizes) together[size == kDrawn ? 0 : order(size)] += size == kDrawn ? 0 : size;
    std::size_t smallest = kSizes;
    while (smallest > 1 && together[smallest - 1] <= room) room -= together[--smallest];
    for (std::size_t n = 0; n < corner_count_; n += 3) {
        const std::size_t size = size_at(n);
        if (size != kDrawn && order(size) >= smallest)
            drawn_.insert(drawn_.end(), mesh_.triangles + n, mesh_.triangles + n + 3);
    }
}

template <class Real>
Clusters Clustering<Real>::numbered() const {
    Clusters out;
    std::vector<std::int32_t> number(mesh_.vertex_count, -1);
    for (const std::int32_t vertex : drawn_) number[at(vertex)] = 0;
    for (std::size_t v = 0; v < mesh_.vertex_count; ++v) {
        if (number[v] < 0) continue;
        number[v] = static_cast<std::int32_t>(out.kept.size());
        out.kept.push_back(static_cast<std::int32_t>(v));
    }
    out.triangles.resize(drawn_.size());
    std::transform(drawn_.begin(), drawn_.end(), out.triangles.begin(),
                   [&](std::int32_t vertex) { return number[at(vertex)]; });
    return out;
}

}  // namespace

template <class Real>
Clusters cluster(const MeshView<Real>& mesh, std::size_t most) {
    check_indices(mesh.triangles, mesh.triangle_count, mesh.vertex_count);
    CellGrid<Real> grid(mesh);
    grid.fit(kShare * static_cast<double>(most));
    for (;; grid.coarsen(kCoarser)) {
        Clustering<Real> clustering(mesh, grid);
        const std::size_t count = clustering.triangle_count();
        if (count > most) continue;  // what is left was told from a part of the triangles
        clustering.keep_lone_pieces(most - count);
        return clustering.numbered();
    }
}

template Clusters cluster(const MeshView<float>&, std::size_t);
template Clusters cluster(const MeshView<double>&, std::size_t);

}  // namespace isocore
