// propagate.cpp - Isosurface propagation: from the skeleton cells that hold the isovalue, breadth first through the
// faces that the isosurface crosses. On signs only, never on geometry: a face is crossed iff its corners differ in
// sign, and then both of its cells are. What was visited is drawn lot by lot, in the order of the cells' numbers,
// whoever walked.
//
// Cells come in the order of their lowest points, and a lot has all visited cells whose lowest points are in its range.
// So an edge belongs to the lot with its lower point: no later lot can have cells around it. Most edges are seen by
// that lot alone; the others are sent to it.
#include <algorithm>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "common/collapsed.hpp"
#include "common/crew.hpp"
#include "thinning/mesh/drawing.hpp"
#include "thinning/mesh/exchange.hpp"
#include "thinning/mesh/lots.hpp"
#include "thinning/mesh/thinning.hpp"
#include "thinning/mesh/walk.hpp"

namespace isocore::thinning {
namespace {

using mesh::Field;
using mesh::Hex;
using mesh::Tet;
using std::int32_t;
using std::size_t;
using std::uint32_t;

// Where a lot's vertices, triangles (in corners) and middles begin among all.
struct Places {
    size_t vertex = 0, corner = 0, middle = 0;
};

template <class Coordinate, class Value>
class Propagation {
  public:
    Propagation(const Field<Value>& field, const IndexView& index, double isovalue, int threads, Scratch& scratch)
        : field_(field),
          index_(index),
          isovalue_(isovalue),
          crew_(scratch.crew_of(threads)),
          scratch_(scratch),
          tets_(field, index.tets, isovalue, scratch.tets),
          hexes_(field, index.hexes, isovalue, scratch.hexes) {}

    Mesh<Coordinate> run(bool with_edges) {
        tets_.run(crew_);
        hexes_.run(crew_);
        lots_ = cut_into_lots(tets_, hexes_);
        if (scratch_.drawn.size() < lots()) scratch_.drawn.resize(lots());
        if (scratch_.tables.size() < crew_.size()) scratch_.tables.resize(crew_.size());
        for_lots([&](size_t lot, EdgeTable& table) { draw(lot, table); });
        const Exchange exchange(scratch_.drawn, lots());
        for_lots([&](size_t lot, EdgeTable& table) { exchange.answer(lot, drawn(lot), table); });
        make_room(with_edges);
        for_lots([&](size_t lot, EdgeTable&) { join(lot); });
        if (mesh_.vertices.size() > 3 * on_edges_) for_lots([&](size_t lot, EdgeTable&) { place_middles(lot); });
        if (tets_.met_collapsed() || hexes_.met_collapsed()) drop_collapsed(mesh_.triangles);
        mesh_.seeds = tets_.seeds() + hexes_.seeds();
        mesh_.visited = tets_.size() + hexes_.size();
        return std::move(mesh_);
    }

  private:
    size_t lots() const { return lots_.size() - 1; }
    Drawn& drawn(size_t lot) { return scratch_.drawn[lot]; }

    // Calls work(lot, the thread's table).
    template <class Work>
    void for_lots(const Work& work) {
        crew_.share(lots(), [&](size_t member, size_t lot) { work(lot, scratch_.tables[member]); });
    }

    void draw(size_t lot, EdgeTable& table) {
        const Lot &begin = lots_[lot], &end = lots_[lot + 1];
        Drawn& out = drawn(lot);
        out.triangles.clear();
        out.middles.clear();
        out.abroad.clear();
        table.start(end.tet - begin.tet + 2 * (end.hex - begin.hex), out.edges);
        Drawing<Tet, Value>(field_, isovalue_, tets_).draw(begin.tet, end.tet, out, table);
        Drawing<Hex, Value>(field_, isovalue_, hexes_).draw(begin.hex, end.hex, out, table);
        number_vertices(lot);
    }

    // Numbers the vertices of the edges that are the lot's own, and lists the others. Which edges are is unpredictable,
    // so there is no branch on it: every edge is listed as if it were another's.
    void number_vertices(size_t lot) {
        Drawn& out = drawn(lot);
        const EdgeList& edges = out.edges;
        const size_t size = edges.size();
        out.vertex_of.resize(size);
        out.abroad.resize(size);
        uint32_t* const vertex_of = out.vertex_of.data();
        EdgeAbroad* const abroad = out.abroad.data();
        const int32_t end = lots_[lot + 1].point;
        uint32_t count = 0;
        for (uint32_t place = 0; place < size; ++place) {
            vertex_of[place] = place - count;
            abroad[count].place = place;
            count += low_point(edges[place]) >= end;
        }
        out.abroad.resize(count);
        for (EdgeAbroad& edge : out.abroad) edge.lot = owner_of(low_point(edges[edge.place]), lot + 1);
        out.vertices = static_cast<uint32_t>(size) - count;
    }

    // Whose range of points has a point, which is not before that of lot `first`: mostly that one's.
    uint32_t owner_of(int32_t point, size_t first) const {
        while (lots_[first + 1].point <= point) ++first;
        return static_cast<uint32_t>(first);
    }

    void make_room(bool with_edges) {
        places_.assign(1, {});
        for (size_t lot = 0; lot < lots(); ++lot) {
            const Places& before = places_.back();
            places_.push_back({before.vertex + drawn(lot).vertices, before.corner + drawn(lot).triangles.size(),
                               before.middle + drawn(lot).middles.size()});
        }
        on_edges_ = places_.back().vertex;
        const size_t all = on_edges_ + places_.back().middle;
        if (all > static_cast<size_t>(std::numeric_limits<int32_t>::max())) {
            throw std::length_error("the surface has more vertices than 2^31 - 1; choose another isovalue");
        }
        mesh_.vertices.resize(3 * all);
        mesh_.triangles.resize(places_.back().corner);
        mesh_.edges.resize(with_edges ? 2 * on_edges_ : 0);
    }

    // Places the lot's own vertices, and turns places among its edges into vertices.
    void join(size_t lot) {
        Drawn& from = drawn(lot);
        Array<uint32_t>& vertex_of = from.vertex_of;
        vertex_of.resize(from.edges.size());
        size_t place = 0, vertex = places_[lot].vertex;
        for (const EdgeAbroad& abroad : from.abroad) {
            vertex = place_vertices(from, place, abroad.place, vertex);
            vertex_of[abroad.place] += static_cast<uint32_t>(places_[abroad.lot].vertex);
            place = abroad.place + size_t{1};
        }
        place_vertices(from, place, from.edges.size(), vertex);
        int32_t* out = mesh_.triangles.data() + places_[lot].corner;
        const uint32_t* const vertices = vertex_of.data();
        if (from.middles.empty())
            write_triangles(from.triangles, out, [=](uint32_t corner) { return vertices[corner]; });
        else
            write_triangles(from.triangles, out, [=, first = on_edges_ + places_[lot].middle](uint32_t corner) {
                return corner < Drawn::kMiddles ? vertices[corner]
                                                : static_cast<uint32_t>(first) + (corner - Drawn::kMiddles);
            });
    }

    template <class VertexAt>
    static void write_triangles(const Array<uint32_t>& corners, int32_t* out, const VertexAt& vertex_at) {
        const uint32_t* corner = corners.data();
        for (const uint32_t* const end = corner + corners.size(); corner < end; corner += 3, out += 3) {
            const uint32_t a = vertex_at(corner[0]), b = vertex_at(corner[1]), c = vertex_at(corner[2]);
            out[0] = static_cast<int32_t>(a);
            out[1] = static_cast<int32_t>(b);
            out[2] = static_cast<int32_t>(c);
        }
    }

    // Places the vertices of the edges from `place` on, as far as `end`. Returns the number of the next vertex.
    size_t place_vertices(Drawn& from, size_t place, size_t end, size_t vertex) {
        const Field<Value> field = field_;  // whose pointers stay in registers
        const int32_t* const original = index_.points;
        const size_t edges = from.edges.size();
        Coordinate* out = mesh_.vertices.data() + 3 * vertex;
        if (!mesh_.edges.empty()) write_edges(from.edges, place, end, mesh_.edges.data() + 2 * vertex);
        for (; place < end; ++place, out += 3) {
            if (place + kAhead < edges) prefetch_points(field, original, from.edges[place + kAhead]);
            const EdgeKey edge = from.edges[place];
            const int32_t low = low_point(edge), high = high_point(edge),
                          swapped = (low ^ high) & -int32_t{original[high] < original[low]};  // unpredictable
            field.cross(low ^ swapped, high ^ swapped, isovalue_, out);
            from.vertex_of[place] = static_cast<uint32_t>(vertex++);
        }
        return vertex;
    }

    static void prefetch_points(const Field<Value>& field, const int32_t* original, EdgeKey edge) {
        for (const int32_t point : {low_point(edge), high_point(edge)}) {
            ISOCORE_PREFETCH(field.point(point));
            ISOCORE_PREFETCH(field.point(point) + 2);
            ISOCORE_PREFETCH(field.values + point);
            ISOCORE_PREFETCH(original + point);
        }
    }

    void write_edges(const EdgeList& edges, size_t place, size_t end, int32_t* out) const {
        for (; place < end; ++place) {
            const int32_t a = index_.points[low_point(edges[place])], b = index_.points[high_point(edges[place])];
            *out++ = std::min(a, b);
            *out++ = std::max(a, b);
        }
    }

    void place_middles(size_t lot) {
        const int32_t* corners = mesh_.triangles.data() + places_[lot].corner;
        Coordinate* out = mesh_.vertices.data() + 3 * (on_edges_ + places_[lot].middle);
        for (const auto [first, end] : drawn(lot).middles) {
            std::array<double, 3> sum{};  // over the first corner of each triangle around: the corners of the loop
            for (uint32_t triangle = first; triangle < end; ++triangle) {
                const Coordinate* corner = mesh_.vertices.data() + 3 * static_cast<size_t>(corners[3 * triangle]);
                for (size_t axis = 0; axis < 3; ++axis) sum[axis] += static_cast<double>(corner[axis]);
            }
            for (size_t axis = 0; axis < 3; ++axis) *out++ = static_cast<Coordinate>(sum[axis] / (end - first));
        }
    }

    static constexpr size_t kAhead = 40;  // edges

    const Field<Value>& field_;
    const IndexView& index_;
    double isovalue_;
    Crew& crew_;
    Scratch& scratch_;
    Walk<Tet, Value> tets_;
    Walk<Hex, Value> hexes_;
    std::vector<Lot> lots_;  // and where the last one ends
    std::vector<Places> places_;
    size_t on_edges_ = 0;  // vertices
    Mesh<Coordinate> mesh_;
};

}  // namespace

template <class Coordinate, class Value>
Mesh<Coordinate> propagate(const Field<Value>& field, const IndexView& index, double isovalue, int threads,
                           bool with_edges, Scratch& scratch) {
    return Propagation<Coordinate, Value>(field, index, isovalue, threads, scratch).run(with_edges);
}

template <class Value>
Visited walk(const Field<Value>& field, const IndexView& index, double isovalue, Scratch& scratch) {
    Visited visited;
    Crew alone(1);
    const auto search = [&](auto&& part) {
        part.run(alone);
        visited.seeds += part.seeds();
        return Array<int32_t>(part.cells(), part.cells() + part.size());
    };
    visited.tets = search(Walk<Tet, Value>(field, index.tets, isovalue, scratch.tets));
    visited.hexes = search(Walk<Hex, Value>(field, index.hexes, isovalue, scratch.hexes));
    return visited;
}

template Visited walk<float>(const Field<float>&, const IndexView&, double, Scratch&);
template Visited walk<double>(const Field<double>&, const IndexView&, double, Scratch&);
template Mesh<float> propagate<float>(const Field<float>&, const IndexView&, double, int, bool, Scratch&);
template Mesh<float> propagate<float>(const Field<double>&, const IndexView&, double, int, bool, Scratch&);
template Mesh<double> propagate<double>(const Field<float>&, const IndexView&, double, int, bool, Scratch&);
template Mesh<double> propagate<double>(const Field<double>&, const IndexView&, double, int, bool, Scratch&);

}  // namespace isocore::thinning
