// gluing.cpp - Cells in order, and which of their faces are the same. A face belongs to its lowest point, and so do the
// cells: most faces of a cell have the point that the cell has, and are compared where the cells lie; only the others,
// one of a tetrahedron's four and three of a hexahedron's six, have to be sent to another point. Points are handled in
// ranges, few enough that all that is known of them stays in the cache.
#include "thinning/mesh/gluing.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <stdexcept>
#include <utility>

#include "common/large_pages.hpp"
#include "common/parallel.hpp"
#include "common/prefetch.hpp"
#include "thinning/mesh/faces.hpp"

namespace isocore::thinning {
namespace {

using std::int32_t;
using std::size_t;
using std::uint32_t;

constexpr size_t kChunk = std::size_t{1} << 16, kCellsPerRange = 1024, kMostRanges = 4096, kCellsAhead = 16,
                 kPointsAhead = 8;

// Ranges of as many points each; the last may have fewer.
struct Ranges {
    size_t points, count;
    unsigned shift = 0;

    Ranges(size_t points_there, size_t cells) : points(points_there) {
        const size_t wanted = std::clamp<size_t>(cells / kCellsPerRange, 1, kMostRanges);
        while ((points >> shift) + 1 > wanted) ++shift;
        count = (points >> shift) + 1;
    }
    size_t of(int32_t point) const { return static_cast<size_t>(point) >> shift; }
    int32_t first(size_t range) const { return static_cast<int32_t>(std::min(points, range << shift)); }
    size_t size(size_t range) const { return static_cast<size_t>(first(range + 1) - first(range)); }
};

// A stable sort into ranges, chunk by chunk: for_each(chunk, add) calls add(range, item) for the chunk's items, twice.
// The items come into `items`, which is made larger where it must be, and those of a range begin at its `start`.
template <class Item, class ForEach>
void sort_into(const Ranges& ranges, size_t chunks, Array<Item>& items, std::vector<uint32_t>& start, int threads,
               const ForEach& for_each) {
    std::vector<std::vector<uint32_t>> places(chunks);
    parallel_for(threads, chunks, [&](size_t chunk) {
        places[chunk].resize(ranges.count);
        uint32_t* count = places[chunk].data();
        for_each(chunk, [=](size_t range, const auto&) { ++count[range]; });
    });
    uint32_t next = 0;
    start.clear();
    for (size_t range = 0; range < ranges.count; ++range) {
        start.push_back(next);
        for (auto& of_chunk : places) next += std::exchange(of_chunk[range], next);
    }
    start.push_back(next);
    if (items.size() < next) items = large_array<Item>(next);
    parallel_for(threads, chunks, [&](size_t chunk) {
        uint32_t* place = places[chunk].data();
        Item* out = items.data();
        for_each(chunk, [=](size_t range, const auto& item) { out[place[range]++] = item(); });
    });
}

template <class Cell, class Value>
class Gluer {
  public:
    Gluer(const mesh::Field<Value>& field, const int32_t* cells, size_t count, const PointOrder& points, int threads)
        : field_(field),
          cells_(cells),
          count_(count),
          points_(points),
          ranges_(field.size, count),
          odd_(ranges_.count),
          threads_(threads) {
        gluing_.cells = count;
        gluing_.records = large_array<int32_t>(kRecord<Cell> * count);
        gluing_.original = large_array<int32_t>(count);
        group_ = large_array<uint32_t>(field.size + 1);
    }

    Gluing<Cell> run() {
        order_cells();
        pair_faces();
        number_boundary();
        return std::move(gluing_);
    }

  private:
    struct Sent {
        int32_t point, place;
    };
    // The cells at a face of more than two, in the mesh's numbers.
    struct Crowd {
        std::array<int32_t, 4> points;
        std::vector<int32_t> cells;
    };
    // What a range has come across.
    struct Found {
        std::vector<int32_t> boundary, collapsed;
        std::vector<Crowd> crowds;
    };

    const int32_t* record_at(int32_t place) const { return gluing_.record(static_cast<size_t>(place) / Cell::kFaces); }
    int32_t* record(size_t cell) { return gluing_.records.data() + kRecord<Cell> * cell; }

    // Cells by their lowest points: into ranges first, then within each. The lowest points wait where the cells'
    // numbers in the mesh will be.
    void order_cells() {
        Array<int32_t>& lowest = gluing_.original;
        const size_t chunks = (count_ + kChunk - 1) / kChunk;
        parallel_for(threads_, chunks, [&](size_t chunk) {
            for (size_t cell = chunk * kChunk; cell < std::min(count_, (chunk + 1) * kChunk); ++cell) {
                const int32_t* ids = cells_ + Cell::kCorners * cell;
                lowest[cell] = number(ids[0]);
                for (size_t n = 1; n < Cell::kCorners; ++n) lowest[cell] = std::min(lowest[cell], number(ids[n]));
            }
        });
        sort_into(ranges_, chunks, sent_, first_cell_, threads_, [&](size_t chunk, const auto& add) {
            for (size_t cell = chunk * kChunk; cell < std::min(count_, (chunk + 1) * kChunk); ++cell) {
                const int32_t low = lowest[cell];
                add(ranges_.of(low), [=] { return Sent{low, static_cast<int32_t>(cell)}; });
            }
        });
        parallel_for(threads_, ranges_.count, [&](size_t range) { order_range(range); });
        for (const Found& found : odd_) any_collapsed_ |= !found.collapsed.empty();
        group_.back() = static_cast<uint32_t>(count_);
    }

    int32_t number(int32_t point) const { return points_.number[static_cast<size_t>(point)]; }

    void order_range(size_t range) {
        const int32_t base = ranges_.first(range);
        uint32_t* group = group_.data() + base;
        const size_t size = ranges_.size(range);
        std::fill_n(group, size, 0u);
        for (size_t n = first_cell_[range]; n < first_cell_[range + 1]; ++n) ++group[sent_[n].point - base];
        uint32_t next = first_cell_[range];
        std::vector<uint32_t> place(size);
        for (size_t n = 0; n < size; ++n) {
            place[n] = next;
            next += std::exchange(group[n], next);
        }
        const size_t end = first_cell_[range + 1];
        for (size_t n = first_cell_[range]; n < end; ++n) {
            if (n + kCellsAhead < end) ISOCORE_PREFETCH(corners(sent_[n + kCellsAhead].place));
            if (n + kPointsAhead < end) prefetch_points(corners(sent_[n + kPointsAhead].place));
            const size_t cell = place[static_cast<size_t>(sent_[n].point - base)]++;
            const auto mine = static_cast<size_t>(sent_[n].place);
            gluing_.original[cell] = sent_[n].place;
            const auto ids = mesh::upright<Cell>(field_, cells_ + Cell::kCorners * mine);
            int32_t* out = record(cell);
            for (size_t corner = 0; corner < Cell::kCorners; ++corner) out[corner] = number(ids[corner]);
            std::fill_n(out + Cell::kCorners, Cell::kFaces, -1);
        }
        for (size_t cell = first_cell_[range]; cell < first_cell_[range + 1]; ++cell) {
            if (is_collapsed<Cell>(record(cell))) odd_[range].collapsed.push_back(static_cast<int32_t>(cell));
        }
    }

    const int32_t* corners(int32_t cell) const { return cells_ + Cell::kCorners * static_cast<size_t>(cell); }

    void prefetch_points(const int32_t* ids) const {
        for (size_t n = 0; n < Cell::kCorners; ++n) {
            ISOCORE_PREFETCH(field_.point(ids[n]));
            ISOCORE_PREFETCH(points_.number.data() + ids[n]);
        }
    }

    // Calls visit(face, points) for the faces of a cell that have its lowest point, or for those that have not.
    template <class Visit>
    void visit_faces(size_t cell, bool with_lowest, const Visit& visit) const {
        const int32_t* ids = gluing_.record(cell);
        if (!any_collapsed_ || !is_collapsed<Cell>(ids)) for_faces(Cell{}, ids, with_lowest, visit);
    }

    // Faces that do not have their cell's lowest point are sent to the range of their own. Then each range has all
    // faces of its points.
    void pair_faces() {
        std::vector<uint32_t> start;
        const size_t chunks = (count_ + kChunk - 1) / kChunk;
        sort_into(ranges_, chunks, sent_, start, threads_, [&](size_t chunk, const auto& add) {
            for (size_t cell = chunk * kChunk; cell < std::min(count_, (chunk + 1) * kChunk); ++cell) {
                visit_faces(cell, false, [&](size_t face, const std::array<int32_t, 4>& points) {
                    const Sent item{points[0], static_cast<int32_t>(Cell::kFaces * cell + face)};
                    add(ranges_.of(points[0]), [=] { return item; });
                });
            }
        });
        parallel_for(
            threads_, ranges_.count, [] { return Matcher(); },
            [&](Matcher& matcher, size_t range) {
                pair_range(range, sent_.data() + start[range], start[range + 1] - start[range], matcher);
            });
    }

    void pair_range(size_t range, const Sent* sent, size_t count, Matcher& matcher) {
        const int32_t base = ranges_.first(range);
        const size_t size = ranges_.size(range);
        std::vector<uint32_t> end(size + 1);
        for (size_t n = 0; n < count; ++n) ++end[static_cast<size_t>(sent[n].point - base) + 1];
        for (size_t n = 0; n < size; ++n) end[n + 1] += end[n];
        Array<int32_t> places(count);
        for (size_t n = 0; n < count; ++n) places[end[static_cast<size_t>(sent[n].point - base)]++] = sent[n].place;
        for (size_t n = 0, begin = 0; n < size; begin = end[n++]) {
            const size_t first = group_[static_cast<size_t>(base) + n],
                         last = group_[static_cast<size_t>(base) + n + 1];
            matcher.clear(Cell::kFaces * (last - first) + end[n] - begin);
            for (size_t cell = first; cell < last; ++cell) {
                visit_faces(cell, true, [&](size_t face, const std::array<int32_t, 4>& points) {
                    see(range, points, static_cast<int32_t>(Cell::kFaces * cell + face), matcher);
                });
            }
            for (size_t at = begin; at < end[n]; ++at) {
                if (at + kCellsAhead < count) ISOCORE_PREFETCH(record_at(places[at + kCellsAhead]));
                const auto place = static_cast<size_t>(places[at]);
                const int32_t* ids = gluing_.record(place / Cell::kFaces);
                see(range, named_points(Cell{}, ids, place % Cell::kFaces), places[at], matcher);
            }
            matcher.for_each([&](const Matcher::Slot& slot) {
                if (slot.count == 1) odd_[range].boundary.push_back(slot.places[0]);
            });
        }
    }

    int32_t& twin(int32_t place) {
        const auto at = static_cast<size_t>(place);
        return record(at / Cell::kFaces)[Cell::kCorners + at % Cell::kFaces];
    }

    // Glues the second cell at a face to the first, and parts them again where there is a third.
    void see(size_t range, const std::array<int32_t, 4>& points, int32_t place, Matcher& matcher) {
        const Matcher::Slot& slot = matcher.add(points, place);
        if (slot.count == 1) return;
        const auto [one, other] = slot.places;
        if (slot.count == 2) {
            twin(one) = other;
            twin(other) = one;
            return;
        }
        std::vector<Crowd>& crowds = odd_[range].crowds;
        if (slot.count == 3) {
            twin(one) = twin(other) = -1;
            crowds.push_back({points, {cell_at(one), cell_at(other)}});
            odd_[range].boundary.insert(odd_[range].boundary.end(), {one, other});
        }
        odd_[range].boundary.push_back(place);
        const auto same = [&](const Crowd& crowd) { return crowd.points == points; };
        std::find_if(crowds.rbegin(), crowds.rend(), same)->cells.push_back(cell_at(place));
    }

    int32_t cell_at(int32_t place) const { return gluing_.original[static_cast<size_t>(place) / Cell::kFaces]; }

    // Numbers the faces that are glued to nothing, and reports what is odd. Cells that name a point twice have none.
    void number_boundary() {
        Oddities& odd = gluing_.oddities;
        const std::vector<int32_t>* first = nullptr;
        for (Found& found : odd_) {
            gluing_.boundary.insert(gluing_.boundary.end(), found.boundary.begin(), found.boundary.end());
            gluing_.collapsed.insert(gluing_.collapsed.end(), found.collapsed.begin(), found.collapsed.end());
            odd.crowded_faces += found.crowds.size();
            for (Crowd& crowd : found.crowds) {
                std::sort(crowd.cells.begin(), crowd.cells.end());
                if (!first || crowd.cells < *first) first = &crowd.cells;
            }
        }
        if (first) std::copy_n(first->begin(), 3, odd.crowded_cells.begin());
        odd.collapsed_cells = gluing_.collapsed.size();
        for (const int32_t cell : gluing_.collapsed) {
            const int32_t mine = gluing_.original[static_cast<size_t>(cell)];
            if (odd.collapsed_cell < 0 || mine < odd.collapsed_cell) odd.collapsed_cell = mine;
        }
        for (size_t n = 0; n < gluing_.boundary.size(); ++n) twin(gluing_.boundary[n]) = -1 - static_cast<int32_t>(n);
    }

    const mesh::Field<Value>& field_;
    const int32_t* cells_;
    size_t count_;
    const PointOrder& points_;
    Ranges ranges_;
    std::vector<uint32_t> first_cell_;  // of every range
    Array<uint32_t> group_;             // of every point: the first cell whose lowest point it is
    Array<Sent> sent_;                  // to ranges: cells first, faces then
    std::vector<Found> odd_;
    bool any_collapsed_ = false;
    int threads_;
    Gluing<Cell> gluing_;
};

}  // namespace

template <class Cell, class Value>
Gluing<Cell> glue(const mesh::Field<Value>& field, const int32_t* cells, size_t count, const PointOrder& points,
                  int threads) {
    if (count * Cell::kEdges > static_cast<size_t>(std::numeric_limits<int32_t>::max())) {
        throw std::length_error("the mesh has more cells than an index can name");
    }
    if (count == 0) return {};
    return Gluer<Cell, Value>(field, cells, count, points, threads).run();
}

template Gluing<mesh::Tet> glue(const mesh::Field<float>&, const int32_t*, size_t, const PointOrder&, int);
template Gluing<mesh::Tet> glue(const mesh::Field<double>&, const int32_t*, size_t, const PointOrder&, int);
template Gluing<mesh::Hex> glue(const mesh::Field<float>&, const int32_t*, size_t, const PointOrder&, int);
template Gluing<mesh::Hex> glue(const mesh::Field<double>&, const int32_t*, size_t, const PointOrder&, int);

}  // namespace isocore::thinning
