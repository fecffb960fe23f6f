// thinner.cpp - T. Itoh, Y. Yamaguchi, K. Koyamada, "Volume Thinning for Automatic Isosurface Propagation", IEEE
// Visualization 1996; "Fast Isosurface Generation Using the Volume Thinning Algorithm", IEEE TVCG 7(1), 2001.
//
// The paper's rules for its classes C1 to C4 are replaced by one that is both safer and thinner (safe_rule.hpp;
// README.md says where we depart). Every vertex and edge copy keeps the count of the remaining cells that touch it and
// the XOR of their ids: when the count drops to one, the XOR is the survivor, whose boundary has just come free.
#include "thinning/mesh/thinner.hpp"

#include <algorithm>
#include <bit>
#include <utility>
#include <vector>

#include "thinning/safe_rule.hpp"

namespace isocore::thinning {
namespace {

using std::int32_t;
using std::size_t;

struct Touching {
    std::uint32_t extremum : 1 = 0;
    std::uint32_t count : 31 = 0;
    int32_t survivor = 0;  // the XOR of the remaining cells' ids
};

enum : std::uint8_t { kRemoved = 1, kQueued = 2 };

template <class Cell>
class Thinner {
  public:
    Thinner(const Gluing<Cell>& gluing, const double* heights)
        : gluing_(gluing), vertices_(gluing.copy_count), edges_(gluing.edge_count), state_(gluing.cells) {
        count_cells();
        mark_extrema(heights);
    }

    Skeleton run() {
        for (size_t cell = 0; cell < gluing_.cells; ++cell) {
            for (size_t face = 0; face < Cell::kFaces; ++face) {
                if (gluing_.neighbour(cell, face) < 0) queue(static_cast<int32_t>(cell));
            }
        }
        remove_simple();
        if (gluing_.shells > 1) {
            label_outside();
            while (prick() || tunnel()) remove_simple();
        }
        return collect();
    }

  private:
    const int32_t* copies(size_t cell) const { return gluing_.copies.data() + Cell::kCorners * cell; }
    const int32_t* edges(size_t cell) const { return gluing_.edges.data() + Cell::kEdges * cell; }
    Touching& vertex(int32_t copy) { return vertices_[static_cast<size_t>(copy)]; }
    Touching& edge(int32_t copy) { return edges_[static_cast<size_t>(copy)]; }
    bool remains(size_t cell) const { return !(state_[cell] & kRemoved); }

    void count_cells() {
        for (size_t cell = 0; cell < gluing_.cells; ++cell) {
            const auto add = [id = static_cast<int32_t>(cell)](Touching& touching) {
                ++touching.count;
                touching.survivor ^= id;
            };
            for (size_t n = 0; n < Cell::kCorners; ++n) add(vertex(copies(cell)[n]));
            for (size_t n = 0; n < Cell::kEdges; ++n) add(edge(edges(cell)[n]));
        }
    }

    // Compares along the edges of cells only, also in hexahedra: a saddle inside one is no extremum, but two corners
    // across it may both be.
    void mark_extrema(const double* heights) {
        enum : std::uint8_t { kHasLower = 1, kHasHigher = 2 };
        std::vector<std::uint8_t> seen(gluing_.copy_count);
        for (size_t cell = 0; cell < gluing_.cells; ++cell) {
            const int32_t* points = gluing_.corners.data() + Cell::kCorners * cell;
            std::array<double, Cell::kCorners> height;
            for (size_t n = 0; n < Cell::kCorners; ++n) height[n] = heights[points[n]];
            std::array<std::uint8_t, Cell::kCorners> marks{};
            for (const auto& [a, b] : Cell::kShape.ends) {
                const bool above = height[a] != height[b] ? height[a] > height[b] : points[a] > points[b];
                marks[a] |= above ? kHasLower : kHasHigher;
                marks[b] |= above ? kHasHigher : kHasLower;
            }
            for (size_t n = 0; n < Cell::kCorners; ++n) seen[static_cast<size_t>(copies(cell)[n])] |= marks[n];
        }
        for (size_t copy = 0; copy < gluing_.copy_count; ++copy) {
            if (vertices_[copy].count == 0 || seen[copy] == (kHasLower | kHasHigher)) continue;
            vertices_[copy].extremum = 1;
            ++extrema_;
        }
    }

    void queue(int32_t cell) {
        std::uint8_t& state = state_[static_cast<size_t>(cell)];
        if (state != 0) return;  // removed, or waiting already
        state = kQueued;
        waiting_.push_back(cell);
    }

    Used used(size_t cell) const {
        Used out;
        for (size_t n = 0; n < Cell::kCorners; ++n)
            out.corners |= Mask{vertices_[static_cast<size_t>(copies(cell)[n])].count > 1} << n;
        for (size_t n = 0; n < Cell::kEdges; ++n)
            out.edges |= Mask{edges_[static_cast<size_t>(edges(cell)[n])].count > 1} << n;
        for (size_t n = 0; n < Cell::kFaces; ++n) {
            const int32_t across = gluing_.neighbour(cell, n);
            out.faces |= Mask{across >= 0 && remains(static_cast<size_t>(across))} << n;
        }
        return out;
    }

    // Would its removal be safe, and leave every extremum in a remaining cell?
    bool is_safe(size_t cell, const Used& used) const {
        for (Mask left = ~used.corners & ((Mask{1} << Cell::kCorners) - 1); left != 0; left &= left - 1) {
            if (vertices_[static_cast<size_t>(copies(cell)[std::countr_zero(left)])].extremum) return false;
        }
        return is_connected(Cell{}, used);
    }

    void remove(size_t cell) {
        state_[cell] |= kRemoved;
        const auto drop = [&](Touching& touching) {
            touching.survivor ^= static_cast<int32_t>(cell);
            if (--touching.count == 1) queue(touching.survivor);
        };
        for (size_t face = 0; face < Cell::kFaces; ++face) {
            const int32_t across = gluing_.neighbour(cell, face);
            if (across >= 0) queue(across);
        }
        for (size_t n = 0; n < Cell::kEdges; ++n) drop(edge(edges(cell)[n]));
        for (size_t n = 0; n < Cell::kCorners; ++n) drop(vertex(copies(cell)[n]));
        if (!labels_.empty()) join_outside(cell);
    }

    // Peels off cells whose removal changes nothing but the size of what remains, from the boundary inward.
    void remove_simple() {
        for (size_t head = 0; head < waiting_.size(); ++head) {
            const auto cell = static_cast<size_t>(waiting_[head]);
            state_[cell] &= static_cast<std::uint8_t>(~kQueued);
            if (!remains(cell)) continue;
            const Used left = used(cell);
            if (left.euler() == 1 && is_safe(cell, left)) remove(cell);
        }
        waiting_.clear();
    }

    // Outside components: pieces of boundary, each with the removed cells behind it. Named by boundary faces.
    void label_outside() {
        labels_.assign(gluing_.cells, -1);
        outside_.resize(gluing_.boundary_faces);
        for (size_t face = 0; face < gluing_.boundary_faces; ++face) outside_[face] = gluing_.shell[face];
        std::vector<size_t> open;
        for (size_t cell = 0; cell < gluing_.cells; ++cell) {
            for (size_t face = 0; face < Cell::kFaces; ++face) {
                const int32_t twin = gluing_.twins[Cell::kFaces * cell + face];
                if (twin < 0 && !remains(cell)) spread_label(cell, -1 - twin, open);
            }
        }
    }

    void spread_label(size_t start, int32_t label, std::vector<size_t>& open) {
        if (labels_[start] >= 0) return unite(labels_[start], label);
        labels_[start] = label;
        open.push_back(start);
        while (!open.empty()) {
            const size_t cell = open.back();
            open.pop_back();
            for (size_t face = 0; face < Cell::kFaces; ++face) {
                const int32_t across = gluing_.neighbour(cell, face);
                if (across < 0 || remains(static_cast<size_t>(across)) || labels_[static_cast<size_t>(across)] >= 0)
                    continue;
                labels_[static_cast<size_t>(across)] = label;
                open.push_back(static_cast<size_t>(across));
            }
        }
    }

    int32_t find(int32_t label) {
        auto& parent = outside_;
        while (parent[static_cast<size_t>(label)] != label) {
            label = parent[static_cast<size_t>(label)] =
                parent[static_cast<size_t>(parent[static_cast<size_t>(label)])];
        }
        return label;
    }
    void unite(int32_t a, int32_t b) {
        a = find(a);
        b = find(b);
        outside_[static_cast<size_t>(std::max(a, b))] = std::min(a, b);
    }

    // The outside component behind a face, or -1 where a cell remains.
    int32_t outside(size_t cell, size_t face) {
        const int32_t twin = gluing_.twins[Cell::kFaces * cell + face];
        if (twin < 0) return find(-1 - twin);
        const size_t across = static_cast<size_t>(twin) / Cell::kFaces;
        return remains(across) ? -1 : find(labels_[across]);
    }

    void join_outside(size_t cell) {
        for (size_t face = 0; face < Cell::kFaces; ++face) {
            const int32_t label = outside(cell, face);
            if (label < 0) continue;
            if (labels_[cell] < 0) labels_[cell] = label;
            unite(labels_[cell], label);
        }
    }

    // Outside components that a cell's faces lie at.
    size_t components_at(size_t cell) {
        std::array<int32_t, Cell::kFaces> seen;
        size_t count = 0;
        for (size_t face = 0; face < Cell::kFaces; ++face) {
            const int32_t label = outside(cell, face);
            if (label >= 0 && std::find(seen.begin(), seen.begin() + count, label) == seen.begin() + count)
                seen[count++] = label;
        }
        return count;
    }

    // Opens voids: removes a cell whose free pieces lie at as many different outside components, so that no tunnel is
    // dug.
    bool may_prick(size_t cell, const Used& left) {
        const int pieces = 2 - left.euler();
        return pieces >= 2 && is_safe(cell, left) && components_at(cell) == static_cast<size_t>(pieces);
    }

    bool prick() {
        bool any = false;
        for (size_t cell = 0; cell < gluing_.cells; ++cell) {
            if (!remains(cell) || !may_prick(cell, used(cell))) continue;
            remove(cell);
            remove_simple();
            any = true;
        }
        return any;
    }

    // Where no single cell reaches both sides: the outside components grow into what remains, and where two of them
    // meet the cells on the way are removed from one side to the other, as far as each step is safe.
    bool tunnel() {
        std::vector<int32_t> reached_from(gluing_.cells, -1), owner(gluing_.cells, -1);
        std::vector<size_t> open;
        for (size_t cell = 0; cell < gluing_.cells; ++cell) {
            for (size_t face = 0; remains(cell) && owner[cell] < 0 && face < Cell::kFaces; ++face)
                owner[cell] = outside(cell, face);
            if (owner[cell] >= 0) open.push_back(cell);
        }
        for (size_t head = 0; head < open.size(); ++head) {
            const size_t cell = open[head];
            for (size_t face = 0; remains(cell) && face < Cell::kFaces; ++face) {
                const int32_t across = gluing_.neighbour(cell, face);
                if (across < 0 || !remains(static_cast<size_t>(across))) continue;
                const auto other = static_cast<size_t>(across);
                if (owner[other] < 0) {
                    owner[other] = owner[cell];
                    reached_from[other] = static_cast<int32_t>(cell);
                    open.push_back(other);
                } else if (find(owner[other]) != find(owner[cell]) && open_path(reached_from, cell, other)) {
                    return true;
                }
            }
        }
        return false;
    }

    bool open_path(const std::vector<int32_t>& reached_from, size_t one, size_t other) {
        std::vector<size_t> path;
        for (auto cell = static_cast<int32_t>(one); cell >= 0; cell = reached_from[static_cast<size_t>(cell)])
            path.push_back(static_cast<size_t>(cell));
        std::reverse(path.begin(), path.end());
        for (auto cell = static_cast<int32_t>(other); cell >= 0; cell = reached_from[static_cast<size_t>(cell)])
            path.push_back(static_cast<size_t>(cell));
        for (const size_t cell : path) {
            if (!remains(cell) || !is_safe(cell, used(cell))) return false;
            remove(cell);
        }
        return true;
    }

    Skeleton collect() {
        Skeleton skeleton;
        skeleton.extrema = extrema_;
        for (size_t cell = 0; cell < gluing_.cells; ++cell) {
            if (!remains(cell)) continue;
            skeleton.cells.push_back(static_cast<int32_t>(cell));
            ++skeleton.classes[static_cast<size_t>(std::popcount(used(cell).faces))];
        }
        std::vector<std::uint8_t> roots(outside_.size());
        for (const int32_t label : outside_) roots[static_cast<size_t>(find(label))] = 1;
        skeleton.outside_components = static_cast<size_t>(std::count(roots.begin(), roots.end(), 1));
        return skeleton;
    }

    const Gluing<Cell>& gluing_;
    std::vector<Touching> vertices_, edges_;
    std::vector<std::uint8_t> state_;
    std::vector<int32_t> waiting_;
    std::vector<int32_t> labels_;   // of removed cells; empty until voids are to be opened
    std::vector<int32_t> outside_;  // union-find over boundary faces
    size_t extrema_ = 0;
};

}  // namespace

template <class Cell>
Skeleton thin(const Gluing<Cell>& gluing, const double* heights) {
    return Thinner<Cell>(gluing, heights).run();
}

template Skeleton thin<mesh::Tet>(const Gluing<mesh::Tet>&, const double*);
template Skeleton thin<mesh::Hex>(const Gluing<mesh::Hex>&, const double*);

}  // namespace isocore::thinning
