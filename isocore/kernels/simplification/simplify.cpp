// simplify.cpp - Half-edge contraction with a bound both ways. README.md in this folder names the papers.
#include "simplification/simplify.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <vector>

#include "common/large_pages.hpp"
#include "common/parallel.hpp"
#include "common/parallel_each.hpp"
#include "simplification/apart.hpp"
#include "simplification/contraction.hpp"
#include "simplification/measuring.hpp"
#include "simplification/sweeps.hpp"

namespace isocore::simplification {
namespace {

constexpr int kPhases = 4;
constexpr float kFirstLimit = 1.0f / 16;  // cells, where a number of triangles is asked for
// How far the boxes of each phase are shifted along each axis, in quarters of a box.
constexpr std::array<std::array<std::int32_t, 3>, kPhases> kShifts{std::array{0, 0, 0}, std::array{2, 2, 2},
                                                                   std::array{1, 3, 1}, std::array{3, 1, 3}};

template <class Real>
void check(const MeshArrays<Real>& input) {
    for (std::size_t n = 0; n < 3 * input.triangle_count; ++n) {
        if (static_cast<std::size_t>(static_cast<std::uint32_t>(input.triangles[n])) >= input.vertex_count)
            throw std::invalid_argument("a triangle names a vertex that does not exist");
    }
}

// Can the first phase make a mesh for each box? Rounding lets triangles of neighbouring boxes meet, a number of
// triangles asked for is reached by edges of the whole mesh, and witnesses are looked for in all of it.
template <class Real>
bool goes_apart(const MeshArrays<Real>& input, const MeshArrays<Real>& reference, const Options& options) {
    return input.vertices == reference.vertices && input.triangles == reference.triangles && input.written == nullptr &&
           options.rounding == 0 && options.most_triangles == 0;
}

template <class Real>
class Simplification {
  public:
    Simplification(const MeshArrays<Real>& input, const MeshArrays<Real>& reference, const Options& options)
        : input_(input),
          options_(options),
          cells_(Cells::around(reference, options.cell)),
          limit_(static_cast<float>(std::min(options.max_error, farthest()))),
          mesh_(options.stretch, options.rounding),
          grid_(cells_, options.rounding) {
        if (goes_apart(input, reference, options)) {
            reference_ = std::make_unique<Reference<Real>>(reference, cells_);
            tally_ = contract_apart(*reference_, limit_, options, mesh_);
            first_phase_ = 1;
            prepare_workers();
        } else {
            // Witnesses come behind the vertices, without a copy of these; room that stays empty takes no memory.
            if (input.vertices != reference.vertices) mesh_.places.reserve(input.vertex_count + reference.vertex_count);
            parallel_for(options.threads, 2, [&](std::size_t n) {  // two that know nothing of each other
                if (n == 0)
                    mesh_.take_all(input, cells_, options.threads);
                else
                    reference_ = std::make_unique<Reference<Real>>(reference, cells_);
            });
            prepare_workers();
            find_witnesses(input, reference, grid_, limit_, options.threads, mesh_);
            return_freed_memory();
            if (mesh_.has_sheets()) mesh_.add_curve_witnesses();
            if (input.vertices == reference.vertices) std::fill(mesh_.proved.begin(), mesh_.proved.end(), 0.0f);
        }
    }

    // The phases that are still to come.
    void run() {
        for (int phase = first_phase_; phase < kPhases; ++phase) run(phase);
    }

    // Contracts the cheapest edges of the whole mesh until no more triangles than asked for are left: as many as a
    // small bound allows, and then those of ever larger bounds.
    void run_to_count() {
        std::vector<std::int32_t> movable;
        Contraction<Real>& worker = *workers_[0];
        const float farthest = limit_;
        for (limit_ = std::min(kFirstLimit, farthest);; limit_ = std::min(2 * limit_, farthest)) {
            worker.set_limit(limit_);
            movable.clear();
            for (std::size_t v = 0; v < mesh_.vertex_count(); ++v) {
                Vertex& vertex = mesh_.vertices[v];
                vertex.failed = 0;
                vertex.movable = vertex.may_move();
                if (vertex.movable) movable.push_back(static_cast<std::int32_t>(v));
            }
            const auto surplus = [&] {
                const std::size_t left = input_.triangle_count - worker.vanished;
                return left > options_.most_triangles ? (left - options_.most_triangles + 1) / 2 : 0;
            };
            sweep(movable, mesh_, worker, costs_, surplus());
            if (surplus() == 0 || limit_ == farthest) return;
        }
    }

    Simplified<Real> take() {
        Simplified<Real> out;
        for (const auto& worker : workers_) tally_.add({worker->collapses, worker->refused()});
        out.facts.collapses = tally_.collapses;
        out.facts.sheets.resize(input_.sheet_count);
        for (std::size_t sheet = 0; sheet < tally_.refused.size(); ++sheet) {
            const auto& refused = tally_.refused[sheet];
            for (std::size_t n = 0; n < kRules; ++n) out.facts.refused[n] += refused[n];
            if (sheet < out.facts.sheets.size()) out.facts.sheets[sheet].refused = refused;
        }
        const Spot other{static_cast<float>(options_.other[0]), static_cast<float>(options_.other[1]),
                         static_cast<float>(options_.other[2])};
        std::vector<Backward<Real>*> provers;
        for (auto& worker : workers_) provers.push_back(&worker->backward());
        measure(mesh_, provers, limit_, other, out.facts);
        workers_.clear();
        reference_.reset();
        return_freed_memory();
        mesh_.give(input_, out);
        return out;
    }

  private:
    void prepare_workers() {
        costs_.resize(mesh_.vertex_count());
        for (int n = 0; n < std::max(options_.threads, 1); ++n)
            workers_.push_back(std::make_unique<Contraction<Real>>(mesh_, *reference_, grid_, limit_));
        for (auto& worker : workers_) worker->backward().prove_all(std::isfinite(options_.max_error));
        enter_triangles();
    }

    // Contracts edges that lie in a box with all that they change, each box for itself.
    void run(int phase) {
        const std::vector<std::vector<std::int32_t>> boxes = find_boxes(kShifts[static_cast<std::size_t>(phase)]);
        std::atomic<std::size_t> next{0};
        parallel_for(options_.threads, std::min(workers_.size(), boxes.size()), [&](std::size_t worker) {
            for (std::size_t box = next++; box < boxes.size(); box = next++) {
                enter_box(boxes[box], phase, workers_[worker]->backward());
                sweep(boxes[box], mesh_, *workers_[worker], costs_, std::numeric_limits<std::size_t>::max());
            }
        });
    }

    // Nothing is further away from anything.
    double farthest() const {
        double sum = 1;
        for (std::size_t a = 0; a < 3; ++a)
            sum += static_cast<double>(cells_.dims[a]) / cells_.per_cell * options_.stretch[a];
        return sum;
    }

    // Some triangles' cubes at a time; each thread enters those that are its own.
    void enter_triangles() {
        constexpr std::size_t kAtOnce = 4096, kRuns = 8;
        const std::size_t count = mesh_.triangles.size(), shares = workers_.size();
        std::vector<TriangleGrid::Spare> spares(shares);
        std::vector<std::vector<std::array<std::int32_t, 2>>> all(shares == 1 ? 1 : kRuns * shares);
        for (std::size_t first = 0; first < count; first += all.size() * kAtOnce) {
            parallel_for(options_.threads, all.size(), [&](std::size_t run) {
                std::vector<std::int32_t> cubes;
                all[run].clear();
                const std::size_t begin = first + run * kAtOnce;
                for (std::size_t t = begin; t < std::min(count, begin + kAtOnce); ++t) {
                    cubes.clear();
                    grid_.cubes_of(mesh_, static_cast<std::int32_t>(t), cubes);
                    for (const std::int32_t cube : cubes) all[run].push_back({cube, static_cast<std::int32_t>(t)});
                }
            });
            parallel_for(options_.threads, shares, [&](std::size_t share) {
                for (const auto& some : all) {
                    for (const auto& [cube, triangle] : some) {
                        if (static_cast<std::size_t>(cube) * shares / grid_.cube_count() == share)
                            grid_.enter(triangle, {&cube, 1}, spares[share]);
                    }
                }
            });
        }
    }

    // visit(vertex) of all, by all threads.
    template <class Visit>
    void each_vertex(const Visit& visit) const {
        constexpr std::size_t kAtOnce = 16384;
        parallel_each(options_.threads, mesh_.vertex_count(), kAtOnce, visit);
    }

    // The vertices that may move, by the box that they lie in with all their neighbours.
    std::vector<std::vector<std::int32_t>> find_boxes(const std::array<std::int32_t, 3>& shift) {
        std::array<std::size_t, 3> dims;
        for (std::size_t a = 0; a < 3; ++a) dims[a] = cells_.dims[a] / kBoxCells + 2;
        std::vector<std::vector<std::int32_t>> boxes(dims[0] * dims[1] * dims[2]);
        std::vector<std::uint32_t> box_of(mesh_.vertex_count());
        each_vertex([&](std::size_t v) {
            const Cell cell = cells_.at(mesh_.places[v].at.data());
            const auto box = [&](std::size_t a) {
                return static_cast<std::size_t>((cell[a] + shift[a] * kBoxCells / 4) / kBoxCells);
            };
            box_of[v] = static_cast<std::uint32_t>(box(0) + dims[0] * (box(1) + dims[1] * box(2)));
        });
        each_vertex([&](std::size_t v) {
            Vertex& vertex = mesh_.vertices[v];
            vertex.movable = vertex.may_move() && has_ring_in_box(vertex, box_of[v], box_of);
        });
        for (std::size_t v = 0; v < box_of.size(); ++v) {
            if (mesh_.vertices[v].movable) boxes[box_of[v]].push_back(static_cast<std::int32_t>(v));
        }
        std::erase_if(boxes, [](const auto& box) { return box.empty(); });
        // The longest first, so that no thread is left with a long one at the end.
        std::stable_sort(boxes.begin(), boxes.end(),
                         [](const auto& one, const auto& other) { return one.size() > other.size(); });
        return boxes;
    }

    // vertices: those of the box. The last phases change too little for copies to pay.
    void enter_box(const std::vector<std::int32_t>& vertices, int phase, Backward<Real>& backward) const {
        constexpr int kPhasesWithCopies = 2;
        if (phase >= kPhasesWithCopies) return backward.leave_box();
        Cell low = cells_.at(mesh_.places[static_cast<std::size_t>(vertices.front())].at.data()), high{};
        for (std::size_t a = 0; a < 3; ++a) {
            const std::int32_t shift = kShifts[static_cast<std::size_t>(phase)][a] * kBoxCells / 4;
            low[a] = (low[a] + shift) / kBoxCells * kBoxCells - shift;
            high[a] = low[a] + kBoxCells - 1;
        }
        backward.enter_box(low, high, limit_);
    }

    bool has_ring_in_box(const Vertex& vertex, std::uint32_t box, const std::vector<std::uint32_t>& box_of) const {
        return std::all_of(vertex.ring, vertex.ring + vertex.count, [&](std::int32_t t) {
            const auto& corners = mesh_.triangles[static_cast<std::size_t>(t)].corners;
            return std::all_of(corners.begin(), corners.end(),
                               [&](std::int32_t corner) { return box_of[static_cast<std::size_t>(corner)] == box; });
        });
    }

    MeshArrays<Real> input_;
    const Options& options_;
    Cells cells_;
    float limit_;
    Mesh<Real> mesh_;
    std::unique_ptr<Reference<Real>> reference_;
    Tally tally_;  // of the first phase, where that is done apart
    int first_phase_ = 0;
    TriangleGrid grid_;
    std::vector<float> costs_;
    std::vector<std::unique_ptr<Contraction<Real>>> workers_;
};

}  // namespace

template <class Real>
Simplified<Real> simplify(const MeshArrays<Real>& input, const MeshArrays<Real>& reference, const Options& options) {
    if (input.triangle_count == 0) return {};
    check(input);
    Simplification<Real> simplification(input, reference, options);
    if (options.most_triangles > 0) {
        simplification.run_to_count();
    } else {
        simplification.run();
    }
    return simplification.take();
}

template Simplified<float> simplify(const MeshArrays<float>&, const MeshArrays<float>&, const Options&);
template Simplified<double> simplify(const MeshArrays<double>&, const MeshArrays<double>&, const Options&);

}  // namespace isocore::simplification
