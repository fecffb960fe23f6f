// extraction.hpp - One extraction, step by step. climb() calls each step once, in the order below, and split() until
// it returns false.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "climbing/boxes/bars.hpp"
#include "climbing/crossings/layout.hpp"
#include "climbing/drawer.hpp"
#include "climbing/error/splitting.hpp"
#include "climbing/types.hpp"
#include "samples/sample_reader.hpp"
#include "samples/signs.hpp"

namespace isocore::climbing {

// Instantiated for float and double coordinates.
template <class Coordinate>
class Extraction {
  public:
    // What is passed by reference must outlive this object.
    Extraction(const SampleReader& samples, const SignGrid& signs, const Options& options,
               const Slopes<Coordinate>& slopes);

    // Finds the highrices of all blocks, and keeps the crossings on their edges.
    void partition();
    // Numbers the kept crossings, which are the vertices, and computes where they are.
    void number_and_place_vertices();
    // Draws the triangles of all bars, and measures how far the dropped crossings lie from them.
    void draw();
    // Halves the boxes that break the error bound, and draws again the bars that this changes. False, and nothing done,
    // if there are no such boxes.
    bool split();
    // The mesh; the last call.
    Mesh<Coordinate> take();

  private:
    using DrawBar = std::function<void(const Drawer::Put&)>;

    void find_directions();
    void draw_stale(const std::function<void(std::size_t, const DrawBar&)>& visit);
    void insert_vertices(std::vector<LateVertex> late);
    std::size_t most_early() const;

    const SampleReader& samples_;
    const SignGrid& signs_;
    const Options& options_;
    const Slopes<Coordinate>& slopes_;  // may be empty
    Bars bars_;
    Layout layout_;
    Mesh<Coordinate> mesh_;
    Array<float> directions_;  // what slopes_ tells of the vertices
};

}  // namespace isocore::climbing
