// grid_thinner.cpp - The safe rule (safe_rule.hpp) where a cell's 26 neighbours are found by index arithmetic. A volume
// is one box, so there is no void to open and no copy of a vertex to tell apart.
#include <algorithm>
#include <bit>
#include <utility>
#include <vector>

#include "common/mesh_cells.hpp"
#include "samples/sample_types.hpp"
#include "thinning/grid/grid_thinning.hpp"
#include "thinning/grid/padded_grid.hpp"
#include "thinning/safe_rule.hpp"

namespace isocore::thinning {
namespace {

using mesh::Hex;
using std::int32_t;
using std::size_t;

// Neighbour n of a cell lies at (n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1); 13 is the cell itself.
constexpr unsigned kNeighbours = 27, kItself = 13;

// The other cells at every corner, edge and face of a cell, as sets of neighbours.
struct Around {
    std::array<std::uint32_t, 8> corners{};
    std::array<std::uint32_t, 12> edges{};
    std::array<std::uint32_t, 6> faces{};
};

// A neighbour touches a corner iff along every axis it is not on the corner's far side.
constexpr Around kAround = [] {
    Around around;
    for (unsigned n = 0; n < kNeighbours; ++n) {
        if (n == kItself) continue;
        Mask touched = 0;
        for (unsigned corner = 0; corner < 8; ++corner) {
            const auto along = [&](unsigned axis) {
                return static_cast<int>(axis == 0 ? n % 3 : axis == 1 ? n / 3 % 3 : n / 9) - 1;
            };
            const auto meets = [&](unsigned axis) {
                return along(axis) == 0 || (along(axis) > 0) == ((corner >> axis & 1) != 0);
            };
            if (meets(0) && meets(1) && meets(2)) touched |= Mask{1} << corner;
        }
        for (unsigned corner = 0; corner < 8; ++corner) around.corners[corner] |= (touched >> corner & 1) << n;
        for (unsigned edge = 0; edge < 12; ++edge) {
            const auto& ends = Hex::kShape.ends[edge];
            if (touched >> ends[0] & touched >> ends[1] & 1) around.edges[edge] |= 1u << n;
        }
        for (unsigned face = 0; face < 6; ++face) {
            if ((touched & Hex::kShape.face_corners[face]) == Hex::kShape.face_corners[face])
                around.faces[face] |= 1u << n;
        }
    }
    return around;
}();

template <class Sample>
class GridThinner {
  public:
    explicit GridThinner(const PaddedGrid<Sample>& grid) : grid_(grid), extremum_(grid.size()) {
        for (size_t axis = 0; axis < 3; ++axis) framed_[axis] = grid.cells[axis] + 2;
        for (unsigned n = 0; n < kNeighbours; ++n) {
            const auto offset = [](unsigned digit) { return static_cast<std::ptrdiff_t>(digit) - 1; };
            const auto row = static_cast<std::ptrdiff_t>(framed_[0]),
                       plane = row * static_cast<std::ptrdiff_t>(framed_[1]);
            offset_[n] = offset(n % 3) + row * offset(n / 3 % 3) + plane * offset(n / 9);
        }
        state_.assign(framed_[0] * framed_[1] * framed_[2], kGone);
        mark_extrema();
    }

    GridSkeleton run() {
        for (size_t k = 0; k < grid_.cells[2]; ++k) {
            for (size_t j = 0; j < grid_.cells[1]; ++j) {
                for (size_t i = 0; i < grid_.cells[0]; ++i) state_[framed({i, j, k})] = kThere;
            }
        }
        for (size_t k = 0; k < grid_.cells[2]; ++k) {
            for (size_t j = 0; j < grid_.cells[1]; ++j) {
                const bool rim = j == 0 || k == 0 || j + 1 == grid_.cells[1] || k + 1 == grid_.cells[2];
                for (size_t i = 0; i < grid_.cells[0]; i += rim || grid_.cells[0] == 1 ? 1 : grid_.cells[0] - 1)
                    queue(framed({i, j, k}));
            }
        }
        std::vector<size_t> now;
        while (!waiting_.empty()) {  // layer by layer
            now.swap(waiting_);
            waiting_.clear();
            for (const size_t cell : now) visit(cell);
        }
        return collect();
    }

  private:
    enum : std::uint8_t { kGone = 0, kThere = 1, kWaiting = 2 };

    size_t framed(const Dims& cell) const {
        return cell[0] + 1 + framed_[0] * (cell[1] + 1 + framed_[1] * (cell[2] + 1));
    }
    Dims cell_at(size_t place) const {
        return {place % framed_[0] - 1, place / framed_[0] % framed_[1] - 1, place / framed_[0] / framed_[1] - 1};
    }

    void mark_extrema() {
        for (size_t k = 0; k < grid_.dims[2]; ++k) {
            for (size_t j = 0; j < grid_.dims[1]; ++j) {
                for (size_t i = 0; i < grid_.dims[0]; ++i) {
                    const Dims at{i, j, k};
                    const double height = grid_.height(at);
                    bool has_lower = false, has_higher = false;
                    for (size_t axis = 0; axis < 3; ++axis) {
                        for (const bool up : {false, true}) {
                            if (up ? at[axis] + 1 == grid_.dims[axis] : at[axis] == 0) continue;
                            Dims other = at;
                            other[axis] += up ? size_t{1} : ~size_t{0};
                            const double there = grid_.height(other);
                            const bool higher = there != height ? there > height : up;
                            has_higher |= higher;
                            has_lower |= !higher;
                        }
                    }
                    if (has_lower && has_higher) continue;
                    extremum_[grid_.id(at)] = 1;
                    ++extrema_;
                }
            }
        }
    }

    void queue(size_t cell) {
        if (state_[cell] != kThere) return;
        state_[cell] = kThere | kWaiting;
        waiting_.push_back(cell);
    }

    std::uint32_t neighbours(size_t cell) const {
        std::uint32_t there = 0;
        for (unsigned n = 0; n < kNeighbours; ++n)
            there |= static_cast<std::uint32_t>(state_[neighbour(cell, n)] & kThere) << n;
        return there;
    }
    size_t neighbour(size_t cell, unsigned n) const {
        return static_cast<size_t>(static_cast<std::ptrdiff_t>(cell) + offset_[n]);
    }

    static Used used(std::uint32_t there) {
        Used out;
        for (unsigned n = 0; n < 8; ++n) out.corners |= Mask{(there & kAround.corners[n]) != 0} << n;
        for (unsigned n = 0; n < 12; ++n) out.edges |= Mask{(there & kAround.edges[n]) != 0} << n;
        for (unsigned n = 0; n < 6; ++n) out.faces |= Mask{(there & kAround.faces[n]) != 0} << n;
        return out;
    }

    bool holds_last_extremum(size_t cell, Mask free) const {
        const size_t low = grid_.id(cell_at(cell));
        for (; free != 0; free &= free - 1) {
            const auto corner = static_cast<size_t>(std::countr_zero(free));
            if (extremum_[low + (corner & 1) + (corner >> 1 & 1) * grid_.step(1) + (corner >> 2) * grid_.step(2)])
                return true;
        }
        return false;
    }

    void visit(size_t cell) {
        state_[cell] = kThere;
        const std::uint32_t there = neighbours(cell);
        const Used left = used(there);
        if (left.euler() != 1 || !is_connected(Hex{}, left) || holds_last_extremum(cell, ~left.corners & 0xff)) return;
        state_[cell] = kGone;
        // The neighbours that the removal may have made removable: those across a face, and whichever is now the only
        // cell left at an edge or a corner.
        std::uint32_t changed = 0;
        for (const std::uint32_t cells : kAround.faces) changed |= there & cells;
        for (const std::uint32_t cells : kAround.edges)
            changed |= std::has_single_bit(there & cells) ? there & cells : 0;
        for (const std::uint32_t cells : kAround.corners)
            changed |= std::has_single_bit(there & cells) ? there & cells : 0;
        for (; changed != 0; changed &= changed - 1)
            queue(neighbour(cell, static_cast<unsigned>(std::countr_zero(changed))));
    }

    GridSkeleton collect() const {
        struct Found {
            double low, high;
            int32_t cell;
        };
        GridSkeleton skeleton;
        std::vector<Found> found;
        int32_t name = 0;
        for (size_t k = 0; k < grid_.cells[2]; ++k) {
            for (size_t j = 0; j < grid_.cells[1]; ++j) {
                for (size_t i = 0; i < grid_.cells[0]; ++i, ++name) {
                    const size_t cell = framed({i, j, k});
                    if (state_[cell] == kGone) continue;
                    ++skeleton.classes[static_cast<size_t>(std::popcount(used(neighbours(cell)).faces))];
                    double low = grid_.height({i, j, k}), high = low;
                    for (size_t corner = 1; corner < 8; ++corner) {
                        const double height =
                            grid_.height({i + (corner & 1), j + (corner >> 1 & 1), k + (corner >> 2)});
                        low = std::min(low, height);
                        high = std::max(high, height);
                    }
                    found.push_back({low, high, name});
                }
            }
        }
        std::sort(found.begin(), found.end(),
                  [](const Found& a, const Found& b) { return a.low != b.low ? a.low < b.low : a.cell < b.cell; });
        for (const auto& [low, high, cell] : found) {
            skeleton.cells.push_back(cell);
            skeleton.low.push_back(low);
            skeleton.high.push_back(high);
        }
        skeleton.extrema = extrema_;
        skeleton.volume_cells = grid_.cell_count();
        return skeleton;
    }

    const PaddedGrid<Sample>& grid_;
    Dims framed_;  // cells per axis, with a frame of absent ones
    std::array<std::ptrdiff_t, kNeighbours> offset_;
    std::vector<std::uint8_t> state_, extremum_;
    std::vector<size_t> waiting_;
    size_t extrema_ = 0;
};

}  // namespace

template <class Sample>
GridSkeleton thin_grid(GridView<Sample> samples, const GridOptions& options) {
    const PaddedGrid<Sample> grid(samples, options);
    return GridThinner<Sample>(grid).run();
}

#define ISOCORE_INSTANTIATE(Sample) template GridSkeleton thin_grid<Sample>(GridView<Sample>, const GridOptions&);
ISOCORE_FOR_EACH_SAMPLE_TYPE(ISOCORE_INSTANTIATE)
#undef ISOCORE_INSTANTIATE

}  // namespace isocore::thinning
