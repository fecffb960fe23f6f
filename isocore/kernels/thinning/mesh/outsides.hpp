// outsides.hpp - What lies outside of the remaining cells: pieces of the mesh's boundary, and voids, each with the
// removed cells behind it; which of them are one; and how far they lie apart.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "thinning/mesh/gluing.hpp"
#include "thinning/zeroed.hpp"

namespace isocore::thinning {

// Union-find over names: numbers of boundary faces first, then of voids.
template <class Cell>
class Outsides {
  public:
    explicit Outsides(const Gluing<Cell>& gluing) : gluing_(gluing), parent_(gluing.boundary.size()) {
        std::iota(parent_.begin(), parent_.end(), 0);
    }

    // Boundary faces that meet at an edge belong to one piece of boundary. Each edge is walked around from the lower.
    void join_boundary() {
        const std::int32_t* records = gluing_.records.data();
        for (std::size_t number = 0; number < gluing_.boundary.size(); ++number) {
            const auto place = static_cast<std::size_t>(gluing_.boundary[number]);
            const std::size_t cell = place / Cell::kFaces, face = place % Cell::kFaces;
            for (Mask left = Cell::kShape.face_edges[face]; left != 0; left &= left - 1) {
                const auto edge = static_cast<std::size_t>(std::countr_zero(left));
                const auto& faces = kFacesAtEdge<Cell>[edge];
                const std::int32_t end =
                    walk_around<Cell>(records, cell, edge, faces[faces[0] == face], [](std::size_t) { return false; });
                const auto at = static_cast<std::size_t>(end);
                unite(static_cast<std::int32_t>(number),
                      -1 - gluing_.record(at / Cell::kFaces)[Cell::kCorners + at % Cell::kFaces]);
            }
        }
    }

    // As many more, which are all apart; the first one's name.
    std::size_t add(std::size_t count) {
        const std::size_t first = parent_.size();
        parent_.resize(first + count);
        std::iota(parent_.begin() + static_cast<std::ptrdiff_t>(first), parent_.end(),
                  static_cast<std::int32_t>(first));
        return first;
    }

    std::int32_t find(std::int32_t name) {
        while (parent_[static_cast<std::size_t>(name)] != name) {
            name = parent_[static_cast<std::size_t>(name)] =
                parent_[static_cast<std::size_t>(parent_[static_cast<std::size_t>(name)])];
        }
        return name;
    }

    void unite(std::int32_t a, std::int32_t b) {
        a = find(a);
        b = find(b);
        parent_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    }

  private:
    const Gluing<Cell>& gluing_;
    Array<std::int32_t> parent_;
};

// How outsides grow into the remaining cells: which outside reached a cell first, and from where.
class Growth {
  public:
    explicit Growth(std::size_t cells) : owner_(cells), from_(cells) {}

    std::int32_t owner(std::size_t cell) const { return owner_.data()[cell] - 1; }
    void reach(std::size_t cell, std::int32_t from, std::int32_t outside) {
        owner_.data()[cell] = outside + 1;
        from_.data()[cell] = from + 1;
    }

    // From one outside by way of two cells that share a face to the other.
    std::vector<std::size_t> path(std::size_t one, std::size_t other) const {
        std::vector<std::size_t> path;
        const auto add = [&](std::size_t start) {
            for (auto cell = static_cast<std::int32_t>(start); cell >= 0;
                 cell = from_.data()[static_cast<std::size_t>(cell)] - 1)
                path.push_back(static_cast<std::size_t>(cell));
        };
        add(one);
        std::reverse(path.begin(), path.end());
        add(other);
        return path;
    }

  private:
    Zeroed owner_, from_;
};

}  // namespace isocore::thinning
