// curve_vertices.hpp - Smoothing along the curves of a label map.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "labels/label_mesh.hpp"
#include "labels/sliding.hpp"

namespace isocore::labels {

// The vertices of the curves in which three labels and more meet: middles of faces, each between those of its two
// cells, and middles of cells.
class CurveVertices {
  public:
    // place: room for a number of each vertex, and one more.
    CurveVertices(const LabelMesh& mesh, Array<std::uint32_t> place) {
        if (mesh.curves.empty()) return;
        std::fill(place.begin(), place.end(), 0);  // where each vertex's neighbours begin
        const auto each = [&](const auto& visit) {
            for (std::size_t n = 0; n < mesh.curves.size(); n += 2) {
                const auto face = static_cast<std::uint32_t>(mesh.curves[n]),
                           cell = static_cast<std::uint32_t>(mesh.curves[n + 1]);
                visit(face, cell);
                if (!(mesh.elements[cell] & kStays)) visit(cell, face);
            }
        };
        each([&](std::uint32_t own, std::uint32_t) { ++place[own + 1]; });
        for (std::uint32_t v = 0; v < mesh.elements.size(); ++v) {
            if (v % kBlock == 0) blocks_.push_back(vertices_.size());
            if (place[v + 1] > 0) {
                const auto across = static_cast<std::uint8_t>(std::countr_one(mesh.elements[v]));
                vertices_.push_back({v, place[v], across, static_cast<std::uint8_t>(place[v + 1])});
            }
            place[v + 1] += place[v];
        }
        blocks_.push_back(vertices_.size());
        neighbours_.resize(place.back());
        each([&](std::uint32_t own, std::uint32_t neighbour) { neighbours_[place[own]++] = neighbour; });
        along_.resize(vertices_.size());
    }

    // Moves those of a block by one step, from their places in `from` to those in `to`.
    void step(std::size_t block, const Places& from, Places& to, float factor, bool new_tangents) {
        if (vertices_.empty()) return;
        for (std::size_t n = blocks_[block]; n < blocks_[block + 1]; ++n) {
            const Vertex& vertex = vertices_[n];
            if (vertex.across == 3) {
                move_in_cell(vertex, from, to, factor);
            } else {
                if (new_tangents) set_tangent(n, from);
                move_in_face(vertex, along_[n], from, to, factor);
            }
        }
    }

  private:
    struct Vertex {
        std::uint32_t number, first;  // its neighbours begin at neighbours_[first]
        std::uint8_t across, degree;  // the axis that a face lies across, 3 for a cell; how many neighbours
    };

    void set_tangent(std::size_t n, const Places& from) {
        const std::uint32_t* neighbour = neighbours_.data() + vertices_[n].first;
        const Lanes along = from[neighbour[1]] - from[neighbour[0]];
        const float length = std::sqrt(dot(along, along)), part = along[vertices_[n].across];
        along_[n] = length > 0 ? (1 / (length * steep(part / length))) * along : Lanes{};
    }

    // To the mean of its two neighbours, then along the curve back to the face.
    void move_in_face(const Vertex& vertex, const Lanes& along, const Places& from, Places& to, float factor) const {
        const std::uint32_t* neighbour = neighbours_.data() + vertex.first;
        const Lanes& own = from[vertex.number];
        Lanes pull = 0.5f * (from[neighbour[0]] + from[neighbour[1]]) - own;
        pull = pull - pull[vertex.across] * along;
        for (const std::size_t axis : {vertex.across == 0 ? 1 : 0, vertex.across == 2 ? 1 : 2})
            to[vertex.number][axis] = kept(own[axis], own[axis] + factor * pull[axis]);
    }

    void move_in_cell(const Vertex& vertex, const Places& from, Places& to, float factor) const {
        Lanes sum{};
        for (std::size_t m = vertex.first; m < vertex.first + vertex.degree; ++m) sum += from[neighbours_[m]];
        const Lanes& own = from[vertex.number];
        const Lanes pull = (1 / static_cast<float>(vertex.degree)) * sum - own;
        for (std::size_t axis = 0; axis < 3; ++axis)
            to[vertex.number][axis] = kept(own[axis], own[axis] + factor * pull[axis]);
    }

    std::vector<Vertex> vertices_;
    std::vector<std::size_t> blocks_;  // where each block's vertices begin
    std::vector<std::uint32_t> neighbours_;
    std::vector<Lanes> along_;  // of a face: the curve's direction, by its own component across the face
};

}  // namespace isocore::labels
