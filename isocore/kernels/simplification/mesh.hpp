// mesh.hpp - The mesh while edges of it are contracted: vertices with the triangles around them, triangles with the
// reference's vertices that they answer for.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "common/array.hpp"
#include "common/predicates.hpp"
#include "common/prefetch.hpp"
#include "common/vectors.hpp"
#include "simplification/cells.hpp"
#include "simplification/quadric.hpp"
#include "simplification/types.hpp"

namespace isocore::simplification {

template <class Real>
struct Place {
    std::array<Real, 3> at;
    std::int32_t next;  // the next witness of the same triangle, where this is one
};

// A witness of which no place is kept.
struct Link {
    std::int32_t from;  // its number in the input, where those of the reference's vertices follow on the input's
    std::int32_t next;
};

struct Triangle {
    std::array<std::int32_t, 3> corners;  // counter-clockwise; kNone once it is gone
    std::int32_t witness;                 // its first witness, or kNone

    bool is_gone() const { return corners[0] == kNone; }
    // Which of the corners a vertex is.
    std::size_t index_of(std::int32_t vertex) const {
        return static_cast<std::size_t>(corners[1] == vertex) + 2 * static_cast<std::size_t>(corners[2] == vertex);
    }
    // The corner that follows on that of this index.
    std::int32_t after(std::size_t index) const { return corners[index == 2 ? 0 : index + 1]; }
};

struct Vertex {
    std::int32_t* ring =
        nullptr;               // its triangles, counter-clockwise; from border to border, where it lies there; on a
                               // curve those of one sheet after the other, each from one neighbour on it to the other
    std::uint64_t failed = 0;  // by place in the ring: the triangle's side that begins here was tried in vain
    std::uint16_t count = 0;   // of triangles; 0 once it is gone
    bool open = false;         // on the border
    bool odd = false;          // its triangles are neither one ring nor one fan: it stays
    bool on_curve = false;     // sheets meet here, each as one fan between the same two neighbours
    bool is_joint = false;     // sheets meet here in any other way: it is odd, but others may be contracted onto it
    bool movable = false;      // may be contracted onto a neighbour now

    bool may_move() const { return count > 0 && !odd && !open; }

    static constexpr std::size_t kMostTriangles = 62;  // around a vertex that may move, or to which another moves
};

// Room for rings: what is handed out stays until the room goes, or is given back and handed out again.
class RingRoom {
  public:
    std::int32_t* take(std::size_t size);
    // Whoever it was taken from.
    void give_back(std::int32_t* ring, std::size_t size);

  private:
    std::array<std::int32_t*, 64> free_{};  // by size: the first, in which the address of the next is kept
    std::vector<std::unique_ptr<std::int32_t[]>> blocks_;
    std::size_t left_ = 0;
};

// Room for quadrics, likewise.
class QuadricRoom {
  public:
    Quadric* take();
    void give_back(Quadric* quadric) { free_.push_back(quadric); }

  private:
    std::vector<std::unique_ptr<Quadric[]>> blocks_;
    std::vector<Quadric*> free_;
};

// A place relative to another, stretched.
template <class Real>
Spot relative(const std::array<Real, 3>& place, const std::array<Real, 3>& origin, const Spot& stretch) {
    return {static_cast<float>(place[0] - origin[0]) * stretch[0],
            static_cast<float>(place[1] - origin[1]) * stretch[1],
            static_cast<float>(place[2] - origin[2]) * stretch[2]};
}

class FirstWitnesses;  // first_witnesses.hpp
struct Part;           // part.hpp
struct Remains;        // remains.hpp
template <class Real>
class Joining;

template <class Real>
class Mesh {
  public:
    // Without any vertex.
    Mesh(const std::array<double, 3>& stretch, const Writing& writing);

    // Vertices are renumbered by where they are, triangles by their lowest vertex, so that neighbours are close
    // together in memory. Three ways to fill a mesh: with all of the input; with a part of it; with what is left of all
    // parts, which are then empty.
    void take_all(const MeshArrays<Real>& input, const Cells& cells, int threads);
    void take(const MeshArrays<Real>& input, const Part& part);
    void take(const MeshArrays<Real>& input, const MeshArrays<Real>& reference, std::vector<Remains>& parts);
    // Then, where the mesh is not its own reference: the vertices of that which triangles from number `first` on answer
    // for, behind the vertices.
    void take_witnesses(const MeshArrays<Real>& input, const MeshArrays<Real>& reference,
                        const FirstWitnesses& witnesses, std::size_t first);
    // What is left of the part that was taken.
    Remains remains(const Part& part) const;

    std::size_t vertex_count() const { return vertices.size(); }
    // A place relative to another, stretched.
    Spot relative(const std::array<Real, 3>& place, const std::array<Real, 3>& origin) const {
        return isocore::simplification::relative(place, origin, stretch_);
    }
    const Spot& stretch() const { return stretch_; }
    const Writing& writing() const { return writing_; }
    // How far that moves a vertex along each axis at most, stretched.
    float rounding() const { return rounding_; }

    // What is left, in the order in which it came in.
    void give(const MeshArrays<Real>& input, Simplified<Real>& out) const;

    // What is known of a witness: its place, and which is the next of the same triangle, or kNone.
    std::array<Real, 3> place_of(std::int32_t witness) const {
        const auto number = static_cast<std::size_t>(witness);
        return number < places.size() ? places[number].at : source(links[number - places.size()].from);
    }
    // Asks for that ahead of its use; of none, too.
    void fetch(std::int32_t witness) const {
        const auto number = static_cast<std::size_t>(std::max(witness, 0));
        if (number < places.size())
            ISOCORE_PREFETCH(places.data() + number);
        else
            ISOCORE_PREFETCH(links.data() + (number - places.size()));
    }
    std::int32_t next(std::int32_t witness) const {
        const auto number = static_cast<std::size_t>(witness);
        return number < places.size() ? places[number].next : links[number - places.size()].next;
    }
    void set_next(std::int32_t witness, std::int32_t next) {
        const auto number = static_cast<std::size_t>(witness);
        (number < places.size() ? places[number].next : links[number - places.size()].next) = next;
    }

    Array<Place<Real>> places;  // of the vertices, then of witnesses that are no vertices any more, or never were
    Array<Link> links;          // of further witnesses: what is left of parts has many
    std::vector<Vertex> vertices;
    std::vector<Quadric*> quadrics;  // of vertices that have been looked at, or could be a target
    Array<Triangle> triangles;
    Array<float> proved;  // by triangle: how far its points lie from the reference, at most
    // Numbers in the input: of the vertices, and then of witnesses, where those of the reference's vertices follow on
    // the input's; of the triangles.
    Array<std::int32_t> from_vertices, from_triangles;

    // Sums over triangles are made lot by lot: so many of the input's triangles, of which those of numbers `first` to
    // `end` - 1 are left.
    struct Lot {
        std::size_t first, end;
    };
    std::size_t lot_count() const { return lots_.empty() ? (triangles.size() + kLot - 1) / kLot : lots_.size(); }
    Lot lot(std::size_t number) const {
        if (lots_.empty()) return {number * kLot, std::min(triangles.size(), (number + 1) * kLot)};
        return {lots_[number], number + 1 < lots_.size() ? lots_[number + 1] : triangles.size()};
    }

    // The sheet of a triangle; 0 where the mesh is not made of sheets.
    std::uint32_t sheet_of(std::int32_t triangle) const {
        return sheets_.empty() ? 0 : sheets_[static_cast<std::size_t>(triangle)];
    }
    bool has_sheets() const { return !sheets_.empty(); }
    // The two neighbours on its curve that a vertex on one had in the input.
    const std::array<std::int32_t, 2>& along(std::int32_t vertex) const {
        const auto found = std::lower_bound(on_curves_.begin(), on_curves_.end(), vertex);
        return along_[static_cast<std::size_t>(found - on_curves_.begin())];
    }
    // Where the fans of a vertex on a curve end in its ring; returns how many there are.
    std::size_t find_fans(const Vertex& vertex, std::array<std::size_t, Vertex::kMostTriangles>& ends) const;
    // The neighbours on its curve of a vertex on one: where its first fan begins, and where it ends.
    std::array<std::int32_t, 2> ends_of(std::int32_t vertex) const;
    // The planes of the triangles around a vertex.
    Quadric planes_around(std::int32_t vertex) const;
    // Makes each vertex on a curve a witness of every sheet that meets there.
    void add_curve_witnesses();

  private:
    static constexpr std::size_t kLot = 4096;

    std::array<Real, 3> source(std::int32_t from) const {
        const auto beyond = from - static_cast<std::int32_t>(input_.vertex_count);
        return beyond < 0 ? input_.place(from) : reference_.place(beyond);
    }

    friend class Joining<Real>;  // remains.cpp

    Array<std::int32_t> number_vertices(const MeshArrays<Real>& input, const Cells& cells);
    void number_triangles(const MeshArrays<Real>& input, const Array<std::int32_t>& numbers);
    void find_rings(int threads);
    // How some triangles follow each other around a vertex: in a ring, or from one neighbour to another.
    struct Fan {
        bool open = false, odd = false;
        std::int32_t first = kNone, last = kNone;
    };
    Fan order_fan(std::int32_t vertex, std::int32_t* ring, std::size_t count) const;
    void order_ring(std::int32_t vertex);
    void order_fans(std::int32_t vertex);
    void note_curves();

    Spot stretch_;
    Writing writing_;
    float rounding_;
    MeshArrays<Real> input_{}, reference_{};  // where links lead to
    Array<std::int32_t> rings_;
    Array<Quadric> quadrics_;        // of what was left of parts
    std::vector<std::size_t> lots_;  // where each begins, where some triangles of the input are not there
    Array<std::uint32_t> sheets_;    // by triangle
    // The vertices on curves, in ascending order, and of each its two neighbours.
    Array<std::int32_t> on_curves_;
    Array<std::array<std::int32_t, 2>> along_;
};

}  // namespace isocore::simplification
