// hex_pen.hpp - Draws one hexahedron: its crossed edges in the order of their numbers, and the triangles between them.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "common/mesh_field.hpp"
#include "tables/mesh_cases.hpp"
#include "thinning/mesh/scratch.hpp"

namespace isocore::thinning {

template <class Value>
class HexPen {
    using Hex = mesh::Hex;

  public:
    static constexpr std::size_t kMostEdges = Hex::kEdges, kMostCorners = sizeof(mesh::HexCase::edges);

    HexPen(const mesh::Field<Value>& field, double isovalue) : field_(field), isovalue_(isovalue) {}

    // Writes the crossed edges and returns how many there are.
    std::size_t write_edges(mesh::Mask signs, const std::int32_t* corners, EdgeKey* out) const {
        std::size_t count = 0;
        for (mesh::Mask left = mesh::kCrossedEdges<Hex>[signs]; left != 0; left &= left - 1) {
            const auto& ends = Hex::kShape.ends[static_cast<std::size_t>(std::countr_zero(left))];
            out[count++] = edge_key(corners[ends[0]], corners[ends[1]]);
        }
        return count;
    }

    struct Written {
        std::size_t edges, corners;
    };

    // Writes the corners of the triangles, from the places of the crossed edges.
    Written write_triangles(mesh::Mask signs, const std::int32_t* corners, const std::uint32_t* places,
                            std::uint32_t* out, Drawn& lot) const {
        const mesh::HexCase& drawn = mesh::drawn(
            Hex{}, signs, [&](std::size_t n) { return static_cast<double>(field_.value(corners[n])); }, isovalue_);
        const mesh::Mask crossed = mesh::kCrossedEdges<Hex>[signs];
        std::array<std::uint32_t, Hex::kEdges> place;
        std::size_t edges = 0;
        for (mesh::Mask left = crossed; left != 0; left &= left - 1)
            place[static_cast<std::size_t>(std::countr_zero(left))] = places[edges++];
        const auto first_triangle = static_cast<std::uint32_t>((out - lot.triangles.data()) / 3),
                   first_middle = static_cast<std::uint32_t>(lot.middles.size());
        lot.middles.resize(first_middle + drawn.middles, {0, 0});
        const std::size_t size = 3u * drawn.triangles;
        for (std::uint32_t n = 0; n < size; ++n) {
            const std::size_t edge = drawn.edges[n];
            if (edge < mesh::kMiddle) {
                out[n] = place[edge];
                continue;
            }
            const auto middle = first_middle + static_cast<std::uint32_t>(edge - mesh::kMiddle);
            auto& [first, end] = lot.middles[middle];
            if (end == 0) first = first_triangle + n / 3;
            end = first_triangle + n / 3 + 1;
            out[n] = Drawn::kMiddles + middle;
        }
        return {edges, size};
    }

  private:
    const mesh::Field<Value>& field_;
    double isovalue_;
};

}  // namespace isocore::thinning
