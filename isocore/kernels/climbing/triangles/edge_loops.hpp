// edge_loops.hpp - The loops that the surface draws on highrices, through the kept edges on their faces.
//
// A face of a box is shared with one neighbour or several; the rectangle shared with each is a padi. All ligns of a
// padi are simple, so one iso-line crosses it, and the iso-lines of a whole face form one path from rim to rim that
// meets no lign twice. Such a path is monotone along both axes of the face: it never turns back along either. So the
// kept edges in a face come in the order of their distance along the straight way from where the path enters to where
// it leaves.
//
// A loop is therefore a sequence of stops: the crossed edges of the box (its rim; even numbers) and, between each and
// the next, the face they share (odd numbers). For example, where only corner 0 of a box is inside, the loop is
//
//     stop 0: edge along x   1: a face   2: another edge   3: a face   4: the third edge   5: a face   (0 again)
//
// with exactly one kept edge at every even stop and any number of them, none perhaps, at every odd one. If two kept
// edges lie at stop 1, they are ordered by how far they are from stop 0 towards stop 2.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "climbing/triangles/box_edges.hpp"
#include "climbing/triangles/box_ends.hpp"
#include "climbing/triangles/drawn_site.hpp"
#include "tables/rims.hpp"

namespace isocore::climbing {

class EdgeLoops {
  public:
    // Finds where the kept edges of disk boxes are along their loops. Triangles that follow a loop face outwards.
    void arrange(const BoxEdges& edges, const DrawnSite& site);

    // Sort key of edge n of edges.kept() along its box's loop. Keys of one box are distinct whole numbers.
    float place(std::size_t n) const { return places_[n]; }
    // The faces of its box that edge n lies on, a bit each.
    unsigned faces(std::size_t n) const { return faces_[n]; }

  private:
    struct LoopOfBox {
        BoxEnds ends;
        const LoopStops* stops;
        unsigned visited;  // a bit for each stop that has a kept edge
    };

    void order_in_faces(std::span<const BoxEdge> kept, std::size_t first, std::size_t rim_length);

    std::array<LoopOfBox, BoxEdges::kMostBoxes> loops_;
    std::array<float, BoxEdges::kMostKept> places_;
    std::array<std::uint8_t, BoxEdges::kMostKept> faces_, stops_;
};

}  // namespace isocore::climbing
