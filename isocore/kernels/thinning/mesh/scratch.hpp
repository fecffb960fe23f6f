// scratch.hpp - The memory that a propagation works in, and its threads. An index keeps both for the next isovalue: to
// get memory from the system anew, page by page, takes a fifth of the time, and to start threads and end them a tenth.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "common/array.hpp"
#include "common/crew.hpp"
#include "thinning/mesh/edge_table.hpp"
#include "thinning/mesh/marks.hpp"

namespace isocore::thinning {

// What the walk leaves of one kind of cells.
struct WalkScratch {
    Marks marks;                              // all 0 between two walks
    std::vector<Array<std::int32_t>> queues;  // of every thread
    Array<std::int32_t> cells;                // that were visited, ascending, and room for more
    Array<std::uint8_t> signs;                // which corners of each are inside
};

// An edge whose vertex is another lot's.
struct EdgeAbroad {
    std::uint32_t place, lot;  // among the drawing lot's edges; whose it is
};

// What a lot of cells draws. A triangle's corners are places among the lot's edges, or, from kMiddles on, middles of
// loops.
struct Drawn {
    static constexpr std::uint32_t kMiddles = std::uint32_t{1} << 31;
    EdgeList edges;                  // as they were first seen; then those that only other lots have seen
    Array<std::uint32_t> vertex_of;  // by place: the edge's vertex among those of its lot
    std::uint32_t vertices;          // its own
    Array<EdgeAbroad> abroad;        // the edges that are other lots', ascending
    Array<std::uint32_t> triangles;
    std::vector<std::array<std::uint32_t, 2>> middles;  // the triangles around each: first, end
};

struct Scratch {
    WalkScratch tets, hexes;
    std::vector<EdgeTable> tables;  // of every thread
    std::vector<Drawn> drawn;       // by lot
    std::unique_ptr<Crew> crew;

    Crew& crew_of(int threads) {
        if (!crew || !crew->is_of(threads)) crew = std::make_unique<Crew>(threads);
        return *crew;
    }
};

// Scratch memory for as many propagations as run at once.
class ScratchPool {
  public:
    // Calls work(scratch) and returns what it returns. What fails leaves no scratch behind.
    template <class Work>
    auto lend(const Work& work) {
        std::unique_ptr<Scratch> scratch = take();
        auto result = work(*scratch);
        const std::lock_guard<std::mutex> lock(guard_);
        spare_.push_back(std::move(scratch));
        return result;
    }

  private:
    std::unique_ptr<Scratch> take() {
        const std::lock_guard<std::mutex> lock(guard_);
        if (spare_.empty()) return std::make_unique<Scratch>();
        std::unique_ptr<Scratch> scratch = std::move(spare_.back());
        spare_.pop_back();
        return scratch;
    }

    std::mutex guard_;
    std::vector<std::unique_ptr<Scratch>> spare_;
};

}  // namespace isocore::thinning
