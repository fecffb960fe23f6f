#include "simplification/boxes.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "common/parallel_each.hpp"

namespace isocore::simplification {
namespace {

template <class Real>
class BoxFinder {
  public:
    BoxFinder(Mesh<Real>& mesh, const Cells& cells, const Cell& shift, int threads)
        : mesh_(mesh), cells_(cells), shift_(shift), threads_(threads), box_of_(mesh.vertex_count()) {
        for (std::size_t a = 0; a < 3; ++a) dims_[a] = cells.dims[a] / kBoxCells + 2;
    }

    std::vector<MeshBox> find() {
        each_vertex([&](std::size_t v) {
            const std::array<Real, 3>& place = mesh_.places[v].at;
            const Cell low = box_at(place, -cells_.margin),
                       high = cells_.margin > 0 ? box_at(place, cells_.margin) : low;
            box_of_[v] = low == high ? static_cast<std::uint32_t>(number_of(low, dims_)) : kNoBox;
        });
        each_vertex([&](std::size_t v) {
            Vertex& vertex = mesh_.vertices[v];
            vertex.movable = vertex.may_move() && box_of_[v] != kNoBox && has_ring_in_box(vertex, box_of_[v]);
        });
        std::vector<MeshBox> boxes(dims_[0] * dims_[1] * dims_[2]);
        for (std::size_t v = 0; v < box_of_.size(); ++v) {
            if (mesh_.vertices[v].movable) boxes[box_of_[v]].vertices.push_back(static_cast<std::int32_t>(v));
        }
        place_triangles(boxes);
        find_cells(boxes);
        std::erase_if(boxes, [](const MeshBox& box) { return box.vertices.empty(); });
        // So that no thread is left with a long one at the end.
        std::stable_sort(boxes.begin(), boxes.end(), [](const MeshBox& one, const MeshBox& other) {
            return one.vertices.size() > other.vertices.size();
        });
        return boxes;
    }

  private:
    // visit(vertex) of all, by all threads.
    template <class Visit>
    void each_vertex(const Visit& visit) const {
        constexpr std::size_t kAtOnce = 16384;
        parallel_each(threads_, mesh_.vertex_count(), kAtOnce, visit);
    }

    // The box of a place that is moved by a step along each axis.
    Cell box_at(const std::array<Real, 3>& place, double step) const {
        Cell out = cells_.home(place.data(), step);
        for (std::size_t a = 0; a < 3; ++a) out[a] = (out[a] + shift_[a]) / kBoxCells;
        return out;
    }

    bool has_ring_in_box(const Vertex& vertex, std::uint32_t box) const {
        return std::all_of(vertex.ring, vertex.ring + vertex.count, [&](std::int32_t t) {
            const auto& corners = mesh_.triangles[static_cast<std::size_t>(t)].corners;
            return std::all_of(corners.begin(), corners.end(),
                               [&](std::int32_t corner) { return box_of_[static_cast<std::size_t>(corner)] == box; });
        });
    }

    void place_triangles(std::vector<MeshBox>& boxes) const {
        for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
            const Triangle& triangle = mesh_.triangles[t];
            if (triangle.is_gone()) continue;
            const auto box_of = [&](std::size_t n) { return box_of_[static_cast<std::size_t>(triangle.corners[n])]; };
            const std::uint32_t own = box_of(0);
            if (own != kNoBox && box_of(1) == own && box_of(2) == own) {  // as most are
                if (!boxes[own].vertices.empty()) boxes[own].triangles.push_back(static_cast<std::int32_t>(t));
                continue;
            }
            Cell low, high;
            find_boxes_of(triangle, low, high);
            each_cell_between(low, high, [&](const Cell& at) {
                MeshBox& box = boxes[number_of(at, dims_)];
                if (!box.vertices.empty()) box.triangles.push_back(static_cast<std::int32_t>(t));
            });
        }
    }

    // Those from `low` to `high`.
    void find_boxes_of(const Triangle& triangle, Cell& low, Cell& high) const {
        for (std::size_t n = 0; n < 3; ++n) {
            const Cell at = box_at(mesh_.places[static_cast<std::size_t>(triangle.corners[n])].at, 0);
            for (std::size_t a = 0; a < 3; ++a) {
                low[a] = n == 0 ? at[a] : std::min(low[a], at[a]);
                high[a] = n == 0 ? at[a] : std::max(high[a], at[a]);
            }
        }
    }

    void find_cells(std::vector<MeshBox>& boxes) const {
        Cell last;
        for (std::size_t a = 0; a < 3; ++a) last[a] = static_cast<std::int32_t>(dims_[a] - 1);
        each_cell_between({0, 0, 0}, last, [&](const Cell& at) {
            MeshBox& box = boxes[number_of(at, dims_)];
            for (std::size_t a = 0; a < 3; ++a) {
                const std::int32_t begin = at[a] * kBoxCells - shift_[a];
                box.low[a] = std::max(begin, 0);
                box.high[a] = std::min(begin + kBoxCells, static_cast<std::int32_t>(cells_.dims[a])) - 1;
            }
        });
    }

    // Of a vertex so near to a wall between boxes that writing could make its triangles meet those beyond.
    static constexpr std::uint32_t kNoBox = std::numeric_limits<std::uint32_t>::max();

    Mesh<Real>& mesh_;
    const Cells& cells_;
    const Cell& shift_;
    int threads_;
    std::array<std::size_t, 3> dims_;    // in boxes
    std::vector<std::uint32_t> box_of_;  // of each vertex
};

}  // namespace

template <class Real>
std::vector<MeshBox> find_boxes(Mesh<Real>& mesh, const Cells& cells, const Cell& shift, int threads) {
    return BoxFinder<Real>(mesh, cells, shift, threads).find();
}

template std::vector<MeshBox> find_boxes(Mesh<float>&, const Cells&, const Cell&, int);
template std::vector<MeshBox> find_boxes(Mesh<double>&, const Cells&, const Cell&, int);

}  // namespace isocore::simplification
