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
    void answer(std::size_t lot, Drawn& owner, EdgeTable& table) const {
        constexpr std::uint32_t kUnseen = 0xffffffff;
        const std::size_t first = first_[lot], count = first_[lot + 1] - first;
        if (count == 0) return;
        EdgeList asked;
        Array<std::uint32_t> places(count);
        table.start(count, asked);
        table.place(edges_.data() + first, count, places.data(), asked);
        std::vector<std::uint32_t> number(asked.size(), kUnseen);
        table.match(owner.edges, asked,
                    [&](std::size_t place, std::size_t question) { number[question] = owner.vertex_of[place]; });
        for (std::size_t question = 0; question < asked.size(); ++question) {
            if (number[question] != kUnseen) continue;
            number[question] = owner.vertices++;
            owner.edges.push_back(asked[question]);
        }
        for (std::size_t n = 0; n < count; ++n) *answers_[first + n] = number[places[n]];
    }

  private:
    std::vector<std::size_t> first_;  // of every lot
    Array<EdgeKey> edges_;
    Array<std::uint32_t*> answers_;
};

}  // namespace isocore::thinning
