// in_order.hpp - Bars are drawn by several threads; their triangles come out in the order of the bars, without gaps. A
// thread has to wait only if it is so far ahead of another one, which has perhaps lost its core, that the triangles
// kept aside would fill the memory.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

#include "common/array.hpp"

namespace isocore::climbing {

// For each bar n, on any thread: begin(n), any number of put(n, ...), end(n). Bars are begun in their order.
class InOrder {
  public:
    // count: how many bars there are. most_early: no bar is begun while more vertex numbers than this are kept aside.
    // All triangles must fit into `out`, which must outlive this object.
    InOrder(std::size_t count, std::size_t most_early, Array<std::int32_t>& out);

    // To be called before anything of bar n is drawn; may wait.
    void begin(std::size_t n);
    // Takes more triangles of bar n. What comes before its turn is copied and kept aside.
    void put(std::size_t n, std::span<const std::int32_t> part);
    // To be called once for each bar, when all its triangles were put.
    void end(std::size_t n);
    // Says that some bar will never end. No thread waits any more, and what is in `out` is incomplete.
    void give_up();

  private:
    struct Early {
        std::vector<std::vector<std::int32_t>> parts;
        bool is_ended = false;
    };

    void append(std::span<const std::int32_t> part);

    std::mutex guard_;
    std::condition_variable ended_;
    std::size_t most_early_, early_size_ = 0;  // vertex numbers kept aside
    std::size_t next_ = 0, size_ = 0;          // the bar whose turn it is, and the vertex numbers in `out`
    bool is_given_up_ = false;
    std::vector<Early> early_;  // by bar
    Array<std::int32_t>& out_;
};

}  // namespace isocore::climbing
