// disks.hpp - Draws the highrices of several cells, each as a disk through its edge loop, and has them measured.
//
// Many boxes at a time: their edges are one list (box_edges), their loops are arranged together (edge_loops), and boxes
// whose loops are equally long are triangulated eight at once, a loop in each lane (polygons). So the branches of each
// step depend on how many boxes there are, and not on what a single box holds.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <tuple>
#include <utility>

#include "climbing/boxes/halvings.hpp"
#include "climbing/error/ruler.hpp"
#include "climbing/triangles/box_edges.hpp"
#include "climbing/triangles/drawn_site.hpp"
#include "climbing/triangles/edge_loops.hpp"
#include "climbing/triangles/placed_vertices.hpp"
#include "climbing/triangles/polygon.hpp"
#include "climbing/triangles/polygons.hpp"
#include "climbing/triangles/triangle_list.hpp"
#include "climbing/types.hpp"

namespace isocore::climbing {

// For each bar: begin_bar(), draw() for each block in the bar's order, end_bar().
class Disks {
  public:
    Disks(const SampleReader& samples, const SignGrid& signs, const Options& options, const PlacedVertices& vertices);

    void begin_bar() { drawn_ = 0; }
    // Appends the triangles of some boxes of the block that the site has loaded, shorter loops before longer ones.
    void draw(const DrawnSite& site, std::span<const Piece> boxes, TriangleList& out, Bar& bar);
    // Writes to the bar what was measured, and the numbers of the boxes that break the bound, in order.
    void end_bar(Bar& bar);

  private:
    template <std::size_t... n>
    static std::tuple<Polygons<n + 3>...> all_polygons(std::index_sequence<n...>);
    using LoopRanks = std::array<float, kLanes>;  // by loop

    void draw_added(const DrawnSite& site, TriangleList& out, Bar& bar);
    void sort_by_length();
    template <std::size_t length>
    void draw_short(const DrawnSite& site, TriangleList& out, Bar& bar);
    template <std::size_t length>
    void fill(Polygons<length>& polygons, const DrawnSite& site, std::span<const std::uint8_t> boxes) const;
    template <std::size_t length>
    std::array<LoopRanks, length> rank(std::span<const std::uint8_t> boxes) const;
    void draw_long(const DrawnSite& site, std::size_t box, TriangleList& out, Bar& bar);
    Vector<double> origin(const DrawnSite& site, std::size_t box) const;
    template <class Set>
    void set_corner(const DrawnSite& site, std::size_t n, const Vector<double>& origin, const Set& set) const;
    template <class Visit>
    void measure(std::size_t box, std::size_t triangles, Bar& bar, const Visit& visit);

    const SignGrid& signs_;
    const Options& options_;
    PlacedVertices vertices_;
    BoxEdges edges_;
    EdgeLoops loops_;
    // Boxes by the length of their loops; the last list has those that are too long for Polygons.
    std::array<std::array<std::uint8_t, BoxEdges::kMostBoxes>, kLongestOfSeveral + 2> by_length_;
    std::array<std::size_t, kLongestOfSeveral + 2> sizes_;  // of these lists
    decltype(all_polygons(std::make_index_sequence<kLongestOfSeveral - 2>{})) polygons_;
    Polygon polygon_;
    std::array<std::pair<float, std::uint32_t>, BoxEdges::kMostOfBox> order_;  // scratch of draw_long
    Ruler ruler_;
    std::size_t drawn_ = 0;  // the bar's boxes before those in edges_
};

}  // namespace isocore::climbing
