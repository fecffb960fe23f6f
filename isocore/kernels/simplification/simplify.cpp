// simplify.cpp - Half-edge contraction with a bound both ways. README.md in this folder names the papers.
#include "simplification/simplify.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "common/large_pages.hpp"
#include "common/parallel.hpp"
#include "simplification/apart.hpp"
#include "simplification/boxes.hpp"
#include "simplification/contraction.hpp"
#include "simplification/first_witnesses.hpp"
#include "simplification/measuring.hpp"
#include "simplification/sweeps.hpp"

namespace isocore::simplification {
namespace {

constexpr int kPhases = 4;
constexpr float kFirstLimit = 1.0f / 16;  // cells, where a number of triangles is asked for
// How far the boxes of each phase are shifted along each axis, in quarters of a box.
constexpr std::array<Cell, kPhases> kShifts{Cell{0, 0, 0}, Cell{2, 2, 2}, Cell{1, 3, 1}, Cell{3, 1, 3}};

template <class Real>
void check(const MeshArrays<Real>& input) {
    for (std::size_t n = 0; n < 3 * input.triangle_count; ++n) {
        if (static_cast<std::size_t>(static_cast<std::uint32_t>(input.triangles[n])) >= input.vertex_count)
            throw std::invalid_argument("a triangle names a vertex that does not exist");
    }
}

// Can the first phase make a mesh for each box? A number of triangles asked for is reached by edges of the whole mesh.
bool goes_apart(const Options& options) { return !options.together && options.most_triangles == 0; }

template <class Real>
class Simplification {
  public:
    Simplification(const MeshArrays<Real>& input, const MeshArrays<Real>& reference, const Options& options)
        : input_(input),
          options_(options),
          cells_(Cells::around(reference, options.cell)),
          limit_(static_cast<float>(std::min(options.max_error, farthest()))),
          mesh_(options.stretch, options.writing) {
        cells_.margin = options.writing.margin();
        if (goes_apart(options)) {
            std::optional<CellIndex> by_cubes;
            parallel_for(options.threads, input.is_same(reference) ? 1 : 2, [&](std::size_t n) {
                if (n == 0)
                    reference_ = std::make_unique<Reference<Real>>(reference, cells_);
                else
                    by_cubes = index_by_cubes(input, Cubes(cells_));
            });
            tally_ = contract_apart(input, *reference_, std::move(by_cubes), limit_, options, mesh_);
            first_phase_ = 1;
        } else {
            take_all(reference);
        }
        prepare_workers();
    }

    // The phases that are still to come.
    void run() {
        for (int phase = first_phase_; phase < kPhases; ++phase) run(phase);
    }

    // Contracts the cheapest edges of the whole mesh until no more triangles than asked for are left: as many as a
    // small bound allows, and then those of ever larger bounds.
    void run_to_count() {
        std::vector<std::int32_t> movable;
        enter_all(*workers_[0]);
        Contraction<Real>& worker = workers_[0]->contraction;
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
        for (const auto& worker : workers_) tally_.add({worker->contraction.collapses, worker->contraction.refused()});
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
        for (auto& worker : workers_) provers.push_back(&worker->contraction.backward());
        measure(mesh_, provers, limit_, other, out.facts);
        workers_.clear();
        reference_.reset();
        return_freed_memory();
        mesh_.give(input_, out);
        return out;
    }

  private:
    // A thread's.
    struct Worker {
        Worker(Mesh<Real>& mesh, const Reference<Real>& reference, float limit, const Options& options)
            : grid(options.writing.rounding), contraction(mesh, reference, grid, limit) {}

        TriangleGrid grid;
        Contraction<Real> contraction;
    };

    void take_all(const MeshArrays<Real>& reference) {
        const bool is_own = input_.is_same(reference);
        // Witnesses come behind the vertices, without a copy of these; room that stays empty takes no memory.
        if (!is_own) mesh_.places.reserve(input_.vertex_count + reference.vertex_count);
        parallel_for(options_.threads, 2, [&](std::size_t n) {  // two that know nothing of each other
            if (n == 0)
                mesh_.take_all(input_, cells_, options_.threads);
            else
                reference_ = std::make_unique<Reference<Real>>(reference, cells_);
        });
        if (!is_own) {
            const Cubes cubes(cells_);
            const FirstWitnesses witnesses = find_witnesses(input_, cubes, index_by_cubes(input_, cubes), reference,
                                                            mesh_.stretch(), limit_, options_.threads);
            mesh_.take_witnesses(input_, reference, witnesses, 0);
        }
        return_freed_memory();
        if (mesh_.has_sheets()) mesh_.add_curve_witnesses();
    }

    void prepare_workers() {
        costs_.resize(mesh_.vertex_count());
        for (int n = 0; n < std::max(options_.threads, 1); ++n) {
            workers_.push_back(std::make_unique<Worker>(mesh_, *reference_, limit_, options_));
            workers_.back()->contraction.backward().prove_all(std::isfinite(options_.max_error));
        }
    }

    // Contracts edges that lie in a box with all that they change, each box for itself.
    void run(int phase) {
        Cell shift = kShifts[static_cast<std::size_t>(phase)];
        for (std::int32_t& quarters : shift) quarters *= kBoxCells / 4;
        std::vector<MeshBox> boxes = find_boxes(mesh_, cells_, shift, options_.threads);
        return_freed_memory();
        std::atomic<std::size_t> next{0};
        parallel_for(options_.threads, std::min(workers_.size(), boxes.size()), [&](std::size_t worker) {
            for (std::size_t n = next++; n < boxes.size(); n = next++) {
                const MeshBox box = std::exchange(boxes[n], {});  // its memory is given back
                enter_box(box, phase, *workers_[worker]);
                sweep(box.vertices, mesh_, workers_[worker]->contraction, costs_,
                      std::numeric_limits<std::size_t>::max());
            }
        });
    }

    void enter_box(const MeshBox& box, int phase, Worker& worker) const {
        worker.grid.cover(cells_, box.low, box.high);
        for (const std::int32_t triangle : box.triangles) worker.grid.enter(mesh_, triangle);
        worker.contraction.look_through_new_grid();
        constexpr int kPhasesWithCopies = 2;  // the last phases change too little for copies to pay
        if (phase < kPhasesWithCopies)
            worker.contraction.backward().enter_box(cells_.first_of_home(box.low), box.high, limit_);
        else
            worker.contraction.backward().leave_box();
    }

    // The whole mesh as one box.
    void enter_all(Worker& worker) const {
        Cell last;
        for (std::size_t a = 0; a < 3; ++a) last[a] = static_cast<std::int32_t>(cells_.dims[a] - 1);
        worker.grid.cover(cells_, {0, 0, 0}, last);
        for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) worker.grid.enter(mesh_, static_cast<std::int32_t>(t));
        worker.contraction.look_through_new_grid();
    }

    // Nothing is further away from anything.
    double farthest() const {
        double sum = 1;
        for (std::size_t a = 0; a < 3; ++a)
            sum += static_cast<double>(cells_.dims[a]) / cells_.per_cell * options_.stretch[a];
        return sum;
    }

    MeshArrays<Real> input_;
    const Options& options_;
    Cells cells_;
    float limit_;
    Mesh<Real> mesh_;
    std::unique_ptr<Reference<Real>> reference_;
    Tally tally_;  // of the first phase, where that is done apart
    int first_phase_ = 0;
    std::vector<float> costs_;
    std::vector<std::unique_ptr<Worker>> workers_;
};

}  // namespace

template <class Real>
Simplified<Real> simplify(const MeshArrays<Real>& input, const MeshArrays<Real>& reference, const Options& options) {
    if (input.triangle_count == 0) return {};
    check(input);
    return_freed_memory();
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
