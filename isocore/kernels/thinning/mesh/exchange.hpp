// exchange.hpp - Edges that a lot of cells has seen and another lot owns: they are sent to it, and it answers with the
// numbers of their vertices.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/array.hpp"
#include "thinning/mesh/edge_table.hpp"
#include "thinning/mesh/scratch.hpp"

namespace isocore::thinning {

class Exchange {
  public:
    // Lists for every lot the edges that other lots have seen of it, in the order of these.
    Exchange(std::vector<Drawn>& drawn, std::size_t lots) : first_(lots + 1) {
        for (std::size_t lot = 0; lot < lots; ++lot) {
            for (const EdgeAbroad& edge : drawn[lot].abroad) ++first_[edge.lot + std::size_t{1}];
        }
        for (std::size_t lot = 0; lot < lots; ++lot) first_[lot + 1] += first_[lot];
        edges_.resize(first_.back());
        answers_.resize(first_.back());
        std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
        for (std::size_t lot = 0; lot < lots; ++lot) {
            for (const EdgeAbroad& edge : drawn[lot].abroad) {
                const std::size_t n = next[edge.lot]++;
                edges_[n] = drawn[lot].edges[edge.place];
                answers_[n] = &drawn[lot].vertex_of[edge.place];
            }
        }
    }

    // Answers with the number of each vertex among the lot's own. Those that the lot has not seen itself come last.
    void answer(std::size_t lot, Drawn& owner) const {
        const std::size_t first = first_[lot], count = first_[lot + 1] - first, seen = owner.edges.size();
        Array<std::uint32_t> places(count);
        owner.edges.place(edges_.data() + first, count, places.data());
        for (std::size_t n = 0; n < count; ++n) {
            const std::size_t place = places[n];
            *answers_[first + n] =
                place < seen ? owner.vertex_of[place] : owner.vertices + static_cast<std::uint32_t>(place - seen);
        }
        owner.vertices += static_cast<std::uint32_t>(owner.edges.size() - seen);
    }

  private:
    std::vector<std::size_t> first_;  // of every lot
    Array<EdgeKey> edges_;
    Array<std::uint32_t*> answers_;
};

}  // namespace isocore::thinning
