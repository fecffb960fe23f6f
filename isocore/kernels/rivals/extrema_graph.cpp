// extrema_graph.cpp - Paths of cells between extrema, as the 1995 paper registers them. Its arcs are found by following
// the field; here all extrema grow at once, breadth first, and where two of them meet that nothing has joined yet, the
// way back to both is the arc. That takes linear time and gives as many arcs as a tree needs.
#include "rivals/extrema_graph.hpp"

#include <algorithm>
#include <numeric>
#include <vector>

namespace isocore::rivals {
namespace {

using std::int32_t;
using std::size_t;

class Graph {
  public:
    Graph(const int32_t* twins, size_t stride, size_t cells, size_t faces)
        : twins_(twins), stride_(stride), faces_(faces), reached_from_(cells, -1), source_(cells, -1), kept_(cells) {}

    Array<int32_t> run(const std::uint8_t* at_extremum) {
        for (size_t cell = 0; cell < source_.size(); ++cell) {
            if (at_extremum[cell]) start(static_cast<int32_t>(cell));
            for (size_t face = 0; face < faces_; ++face) kept_[cell] |= twins_[stride_ * cell + face] < 0;
        }
        root_.resize(waiting_.size());
        std::iota(root_.begin(), root_.end(), 0);
        for (size_t head = 0; head < waiting_.size(); ++head) grow(waiting_[head]);
        Array<int32_t> kept;
        for (size_t cell = 0; cell < kept_.size(); ++cell) {
            if (kept_[cell]) kept.push_back(static_cast<int32_t>(cell));
        }
        return kept;
    }

  private:
    void start(int32_t cell) {
        source_[static_cast<size_t>(cell)] = static_cast<int32_t>(waiting_.size());
        kept_[static_cast<size_t>(cell)] = 1;
        waiting_.push_back(cell);
    }

    void grow(int32_t cell) {
        const auto here = static_cast<size_t>(cell);
        for (size_t face = 0; face < faces_; ++face) {
            const int32_t twin = twins_[stride_ * here + face];
            if (twin < 0) continue;
            const auto other = static_cast<size_t>(twin) / faces_;
            if (source_[other] < 0) {
                source_[other] = source_[here];
                reached_from_[other] = cell;
                waiting_.push_back(static_cast<int32_t>(other));
            } else if (find(source_[other]) != find(source_[here])) {
                root_[static_cast<size_t>(find(source_[other]))] = find(source_[here]);
                keep_path(cell);
                keep_path(static_cast<int32_t>(other));
            }
        }
    }

    void keep_path(int32_t cell) {
        for (; cell >= 0; cell = reached_from_[static_cast<size_t>(cell)]) kept_[static_cast<size_t>(cell)] = 1;
    }

    int32_t find(int32_t source) {
        while (root_[static_cast<size_t>(source)] != source) {
            source = root_[static_cast<size_t>(source)] =
                root_[static_cast<size_t>(root_[static_cast<size_t>(source)])];
        }
        return source;
    }

    const int32_t* twins_;
    size_t stride_, faces_;
    std::vector<int32_t> reached_from_, source_, root_, waiting_;
    std::vector<std::uint8_t> kept_;
};

}  // namespace

Array<int32_t> extrema_graph(const int32_t* twins, size_t stride, size_t cells, size_t faces,
                             const std::uint8_t* at_extremum) {
    return Graph(twins, stride, cells, faces).run(at_extremum);
}

}  // namespace isocore::rivals
