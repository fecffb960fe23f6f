// scratch.hpp - The memory that a propagation works in. An index keeps it for the next isovalue: to get it from the
// system anew, page by page, takes a fifth of the time.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "common/array.hpp"
#include "thinning/mesh/edge_table.hpp"

namespace isocore::thinning {

// What the walk leaves of one kind of cells.
struct WalkScratch {
    std::vector<std::atomic<std::uint64_t>> visited;  // a bit per cell; all 0 between two walks
    Array<std::int32_t> cells;                        // that were visited, ascending
};

// An edge whose vertex is another lot's.
struct EdgeAbroad {
    std::uint32_t place, lot, vertex;  // among the drawing lot's edges; whose it is; its number among that lot's
};

// What a lot of cells draws. A triangle's corners are places among the lot's edges, or, from kMiddles on, middles of
// loops.
struct Drawn {
    static constexpr std::uint32_t kMiddles = std::uint32_t{1} << 31;
    Array<EdgeKey> edges;      // as they were first seen
    Array<EdgeAbroad> abroad;  // those of them that are other lots', ascending
    Array<EdgeKey> received;   // its own edges that only other lots have seen
    Array<std::uint32_t> triangles;
    std::vector<std::array<std::uint32_t, 2>> middles;  // the triangles around each: first, end

    // Calls visit(place) for the edges that are the lot's own.
    template <class Visit>
    void for_own_edges(const Visit& visit) const {
        auto next = abroad.begin();
        for (std::size_t place = 0; place < edges.size(); ++place) {
            if (next != abroad.end() && next->place == place)
                ++next;
            else
                visit(place);
        }
    }

    std::size_t vertices() const { return edges.size() - abroad.size() + received.size(); }
};

// What one thread needs while it draws a lot.
struct DrawScratch {
    EdgeTable table;
    Array<std::uint8_t> signs;      // which corners of every cell are inside
    Array<EdgeKey> edges;           // the crossed edges of all cells, cell by cell
    Array<std::uint32_t> places;    // of these among the lot's edges
    Array<std::uint32_t> vertices;  // by place
};

struct Scratch {
    WalkScratch tets, hexes;
    std::vector<Drawn> drawn;          // by lot
    std::vector<DrawScratch> drawing;  // by thread
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
