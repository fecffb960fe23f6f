// mesh_cells.hpp - The two cells of a mesh: how their corners, edges and faces are numbered, and which edges and faces
// are crossed. Which triangles they draw stands in tables/mesh_cases.hpp.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "common/crossing.hpp"
#include "common/cube.hpp"

namespace isocore::mesh {

// A set of corners, edges or faces of one cell.
using Mask = std::uint32_t;

template <std::size_t corners, std::size_t edges, std::size_t faces>
struct Shape {
    std::array<std::array<std::uint8_t, 2>, edges> ends{};  // the two corners of every edge
    std::array<Mask, faces> face_corners{}, face_edges{};
    std::array<Mask, corners> corner_edges{};

    constexpr void connect() {
        for (std::size_t e = 0; e < edges; ++e) {
            const Mask both = Mask{1} << ends[e][0] | Mask{1} << ends[e][1];
            for (std::size_t f = 0; f < faces; ++f) {
                if ((face_corners[f] & both) == both) face_edges[f] |= Mask{1} << e;
            }
            for (const auto corner : ends[e]) corner_edges[corner] |= Mask{1} << e;
        }
    }
};

// Corners as in VTK: seen from corner 3, corners 0, 1, 2 turn counter-clockwise. Face f lies opposite corner f.
struct Tet {
    static constexpr std::size_t kCorners = 4, kEdges = 6, kFaces = 4, kFaceCorners = 3;
    static constexpr Shape<kCorners, kEdges, kFaces> kShape = [] {
        Shape<kCorners, kEdges, kFaces> shape;
        std::size_t edge = 0;
        for (std::uint8_t a = 0; a < 4; ++a) {
            shape.face_corners[a] = 15u ^ 1u << a;
            for (auto b = static_cast<std::uint8_t>(a + 1); b < 4; ++b) shape.ends[edge++] = {a, b};
        }
        shape.connect();
        return shape;
    }();
    static constexpr std::array<std::uint8_t, 4> kFromVtk{0, 1, 2, 3};   // VTK's number of each of our corners
    static constexpr std::array<std::uint8_t, 4> kMirrored{0, 1, 3, 2};  // the corners of the cell turned inside out
};

// Corners as in cube.hpp.
struct Hex {
    static constexpr std::size_t kCorners = 8, kEdges = 12, kFaces = 6, kFaceCorners = 4;
    static constexpr Shape<kCorners, kEdges, kFaces> kShape = [] {
        Shape<kCorners, kEdges, kFaces> shape;
        for (std::size_t e = 0; e < kEdges; ++e) {
            const int edge = static_cast<int>(e);
            shape.ends[e] = {static_cast<std::uint8_t>(cube::low_corner(edge)),
                             static_cast<std::uint8_t>(cube::high_corner(edge))};
        }
        for (std::size_t f = 0; f < kFaces; ++f) {
            for (const int corner : cube::face_ring(static_cast<int>(f))) shape.face_corners[f] |= Mask{1} << corner;
        }
        shape.connect();
        return shape;
    }();
    static constexpr std::array<std::uint8_t, 8> kFromVtk{0, 1, 3, 2, 4, 5, 7, 6};
    static constexpr std::array<std::uint8_t, 8> kMirrored{4, 5, 6, 7, 0, 1, 2, 3};
};

// Point ids of a cell's corners, in our order.
template <class Cell>
using CornerIds = std::array<std::int32_t, Cell::kCorners>;

// For every pattern of corner signs: the edges whose two ends differ, as a set.
template <class Cell>
constexpr auto kCrossedEdges = [] {
    std::array<std::uint16_t, std::size_t{1} << Cell::kCorners> crossed{};
    for (std::size_t signs = 0; signs < crossed.size(); ++signs) {
        for (std::size_t e = 0; e < Cell::kEdges; ++e) {
            const auto& ends = Cell::kShape.ends[e];
            if ((signs >> ends[0] ^ signs >> ends[1]) & 1)
                crossed[signs] = static_cast<std::uint16_t>(crossed[signs] | 1u << e);
        }
    }
    return crossed;
}();

// For every pattern of corner signs: the faces whose corners are not all alike, as a set.
template <class Cell>
constexpr auto kCrossedFaces = [] {
    std::array<std::uint8_t, std::size_t{1} << Cell::kCorners> crossed{};
    for (std::size_t signs = 0; signs < crossed.size(); ++signs) {
        for (std::size_t f = 0; f < Cell::kFaces; ++f) {
            const Mask corners = Cell::kShape.face_corners[f], inside = static_cast<Mask>(signs) & corners;
            if (inside != 0 && inside != corners) crossed[signs] = static_cast<std::uint8_t>(crossed[signs] | 1u << f);
        }
    }
    return crossed;
}();

}  // namespace isocore::mesh
