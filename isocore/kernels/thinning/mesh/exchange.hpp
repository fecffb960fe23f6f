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
        sent_.resize(first_.back());
        std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
        for (std::size_t lot = 0; lot < lots; ++lot) {
            for (EdgeAbroad& edge : drawn[lot].abroad)
                sent_[next[edge.lot]++] = {drawn[lot].edges[edge.place], &edge.vertex};
        }
    }

    // Answers with the number of each vertex among the lot's own. Those that the lot has not seen itself come last.
    void answer(std::size_t lot, Drawn& owner, DrawScratch& scratch) const {
        const std::size_t first = first_[lot], count = first_[lot + 1] - first;
        if (count == 0) return;
        scratch.edges.resize(count);
        scratch.places.resize(count);
        for (std::size_t n = 0; n < count; ++n) scratch.edges[n] = sent_[first + n].edge;
        scratch.table.start(count);
        scratch.table.place(scratch.edges.data(), count, scratch.places.data());
        scratch.vertices.assign(scratch.table.size(), EdgeTable::kNone);
        std::uint32_t vertex = 0;
        owner.for_own_edges([&](std::size_t place) {
            const std::uint32_t sent = scratch.table.find(owner.edges[place]);
            if (sent != EdgeTable::kNone) scratch.vertices[sent] = vertex;
            ++vertex;
        });
        for (std::size_t n = 0; n < scratch.vertices.size(); ++n) {
            if (scratch.vertices[n] != EdgeTable::kNone) continue;
            scratch.vertices[n] = vertex++;
            owner.received.push_back(scratch.table.edges()[n]);
        }
        for (std::size_t n = 0; n < count; ++n) *sent_[first + n].answer = scratch.vertices[scratch.places[n]];
    }

  private:
    struct Sent {
        EdgeKey edge;
        std::uint32_t* answer;
    };

    std::vector<std::size_t> first_;  // of every lot
    Array<Sent> sent_;
};

}  // namespace isocore::thinning
