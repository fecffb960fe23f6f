// drawer.hpp - From highrices to triangles, one bar at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "climbing/boxes/bars.hpp"
#include "climbing/boxes/block_rices.hpp"
#include "climbing/crossings/layout.hpp"
#include "climbing/disks.hpp"
#include "climbing/triangles/drawn_site.hpp"
#include "climbing/triangles/placed_vertices.hpp"
#include "climbing/triangles/triangle_list.hpp"
#include "climbing/types.hpp"
#include "samples/sample_reader.hpp"
#include "samples/signs.hpp"

namespace isocore::climbing {

// One for each thread: about 0.3 MB, for one block at a time.
class Drawer {
  public:
    // Takes some of a bar's triangles, three vertex numbers each; they are gone after the call.
    using Put = std::function<void(std::span<const std::int32_t>)>;

    // What is passed by reference must outlive this object. The layout's vertices are numbered.
    Drawer(const SampleReader& samples, const SignGrid& signs, const Layout& layout, const Options& options,
           const PlacedVertices& vertices);

    // Draws all boxes of a bar, block by block, and calls put() for each block in turn; then the bar is not stale any
    // more. Writes to the bar how many triangles and ambiguous faces it has, how far dropped crossings lie from the
    // triangles, and which boxes break the error bound.
    void draw(const Bars& bars, std::size_t number, Bar& bar, const Put& put);

  private:
    void draw_cells(Bar& bar, int j, int k, std::uint64_t cells);
    unsigned decide_faces(Bar& bar, unsigned corners, unsigned ambiguous, int i, int j, int k) const;

    const SampleReader& samples_;
    const SignGrid& signs_;
    const Layout& layout_;
    DrawnSite site_;
    BlockRices rices_;
    TriangleList triangles_;  // of one block
    Disks disks_;
};

}  // namespace isocore::climbing
