#include "simplification/apart.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "common/large_pages.hpp"
#include "common/parallel.hpp"
#include "simplification/contraction.hpp"
#include "simplification/first_witnesses.hpp"
#include "simplification/morton.hpp"
#include "simplification/part.hpp"
#include "simplification/remains.hpp"
#include "simplification/sweeps.hpp"

namespace isocore::simplification {
namespace {

// A thread's: what the mesh of one box after the other is made of.
template <class Real>
class Worker {
  public:
    Worker(const IndexedMesh<Real>& whole, const FirstWitnesses* witnesses, const Reference<Real>& reference,
           float limit, const Options& options)
        : whole_(whole),
          witnesses_(witnesses),
          reference_(reference),
          mesh_(options.stretch, options.writing),
          grid_(options.writing.rounding),
          contraction_(mesh_, reference, grid_, limit) {
        contraction_.backward().prove_all(std::isfinite(options.max_error));
    }

    Remains contract(const Cell& low, const Cell& high) {
        take(low, high);
        // A triangle that lies in several boxes has its witnesses in that in which it is numbered: in none it changes.
        if (witnesses_ != nullptr)
            mesh_.take_witnesses(whole_.mesh, reference_.mesh(), *witnesses_, part_.first_numbered);
        if (mesh_.has_sheets()) mesh_.add_curve_witnesses();
        find_movable(low, high);
        if (!movable_.empty()) {
            enter_triangles(low, high);
            contraction_.start_over();
            contraction_.backward().enter_box(whole_.cells.first_of_home(low), high, contraction_.limit());
            costs_.resize(mesh_.vertex_count());
            sweep(movable_, mesh_, contraction_, costs_, std::numeric_limits<std::size_t>::max());
        }
        return mesh_.remains(part_);
    }

    Tally tally() const { return {contraction_.collapses, contraction_.refused()}; }

  private:
    void take(const Cell& low, const Cell& high) {
        PartFinder<Real>(whole_).find(low, high, part_);  // which takes as much memory as the mesh, and gives it back
        mesh_.take(whole_.mesh, part_);
        part_.forget_lists();
    }

    // Those in the box with all their neighbours, and not so near to its walls that writing could make their triangles
    // meet those beyond.
    void find_movable(const Cell& low, const Cell& high) {
        const double margin = whole_.cells.margin;
        const auto is_inside = [&](std::int32_t number) {
            if (margin == 0) return part_.is_own(number);
            const auto& place = mesh_.places[static_cast<std::size_t>(number)].at;
            const Cell from = whole_.cells.home(place.data(), -margin), to = whole_.cells.home(place.data(), margin);
            for (std::size_t a = 0; a < 3; ++a) {
                if (from[a] < low[a] || to[a] > high[a]) return false;
            }
            return true;
        };
        movable_.clear();
        for (std::size_t v = part_.first_own; v < part_.end_own; ++v) {
            Vertex& vertex = mesh_.vertices[v];
            vertex.movable = vertex.may_move() && std::all_of(vertex.ring, vertex.ring + vertex.count, [&](auto t) {
                                 const auto& corners = mesh_.triangles[static_cast<std::size_t>(t)].corners;
                                 return std::all_of(corners.begin(), corners.end(), is_inside);
                             });
            if (vertex.movable) movable_.push_back(static_cast<std::int32_t>(v));
        }
    }

    void enter_triangles(const Cell& low, const Cell& high) {
        grid_.cover(whole_.cells, low, high);
        for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) grid_.enter(mesh_, static_cast<std::int32_t>(t));
    }

    IndexedMesh<Real> whole_;
    const FirstWitnesses* witnesses_;  // none where the mesh is its own reference
    const Reference<Real>& reference_;
    Part part_;
    Mesh<Real> mesh_;
    TriangleGrid grid_;
    Contraction<Real> contraction_;
    std::vector<std::int32_t> movable_;
    std::vector<float> costs_;
};

struct BoxOfCells {
    Cell low, high;      // both included
    std::uint64_t key;   // in the order of Morton
    std::size_t weight;  // how many triangles it has, about
};

// Those that hold triangles, in the order of Morton.
template <class Real>
std::vector<BoxOfCells> find_boxes(const IndexedMesh<Real>& whole) {
    const Cells& cells = whole.cells;
    std::array<std::int32_t, 3> last;
    for (std::size_t a = 0; a < 3; ++a) last[a] = static_cast<std::int32_t>(cells.dims[a] - 1);
    std::vector<BoxOfCells> out;
    Cell low;
    for (low[2] = 0; low[2] <= last[2]; low[2] += kBoxCells) {
        for (low[1] = 0; low[1] <= last[1]; low[1] += kBoxCells) {
            for (low[0] = 0; low[0] <= last[0]; low[0] += kBoxCells) {
                BoxOfCells box{low, low, morton(low, 0), 0};
                for (std::size_t a = 0; a < 3; ++a) box.high[a] = std::min(low[a] + kBoxCells - 1, last[a]);
                whole.each_run_between(low, box.high,
                                       [&](std::uint32_t first, std::uint32_t end) { box.weight += end - first; });
                if (box.weight > 0) out.push_back(box);
            }
        }
    }
    std::sort(out.begin(), out.end(),
              [](const BoxOfCells& one, const BoxOfCells& other) { return one.key < other.key; });
    return out;
}

template <class Real>
Tally contract_boxes(const IndexedMesh<Real>& whole, const FirstWitnesses* witnesses, const Reference<Real>& reference,
                     float limit, const Options& options, std::vector<Remains>& parts) {
    const std::vector<BoxOfCells> boxes = find_boxes(whole);
    std::vector<std::size_t> order(boxes.size());  // the longest first, so that no thread is left with one at the end
    for (std::size_t n = 0; n < order.size(); ++n) order[n] = n;
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t one, std::size_t other) { return boxes[one].weight > boxes[other].weight; });
    parts.resize(boxes.size());
    const auto count = std::min(boxes.size(), static_cast<std::size_t>(std::max(options.threads, 1)));
    std::vector<Tally> found(count);
    std::atomic<std::size_t> next{0};
    parallel_for(options.threads, count, [&](std::size_t number) {
        // As remains become more, boxes become smaller, and so does what a worker has for them.
        constexpr std::size_t kAtOnce = 16, kFewer = 2;
        std::unique_ptr<Worker<Real>> worker;
        std::size_t largest = 0;
        for (std::size_t n = next++; n < boxes.size(); n = next++) {
            const BoxOfCells& box = boxes[order[n]];
            if (worker == nullptr || kFewer * box.weight < largest) {
                if (worker != nullptr) found[number].add(worker->tally());
                worker = std::make_unique<Worker<Real>>(whole, witnesses, reference, limit, options);
                largest = box.weight;
            }
            parts[order[n]] = worker->contract(box.low, box.high);
            if (n % kAtOnce == 0) return_freed_memory();
        }
        if (worker != nullptr) found[number].add(worker->tally());
    });
    Tally sum;
    for (const Tally& one : found) sum.add(one);
    return sum;
}

}  // namespace

void Tally::add(const Tally& other) {
    collapses += other.collapses;
    refused.resize(std::max(refused.size(), other.refused.size()));
    for (std::size_t sheet = 0; sheet < other.refused.size(); ++sheet) {
        for (std::size_t n = 0; n < kRules; ++n) refused[sheet][n] += other.refused[sheet][n];
    }
}

template <class Real>
Tally contract_apart(const MeshArrays<Real>& input, const Reference<Real>& reference, std::optional<CellIndex> by_cubes,
                     float limit, const Options& options, Mesh<Real>& mesh) {
    std::vector<Remains> parts;
    Tally tally;
    if (!by_cubes) {
        // A triangle of the reference that ends where a cell begins is entered in the one before; and where there is a
        // margin, that one's end may be at home in the next.
        const std::int32_t before = reference.cells().margin > 0 ? 2 : 1;
        const IndexedMesh<Real> whole{input, reference.cells(), reference.index(), 0, before};
        tally = contract_boxes<Real>(whole, nullptr, reference, limit, options, parts);
    } else {
        const Cubes cubes(reference.cells());
        const FirstWitnesses witnesses =
            find_witnesses(input, cubes, *by_cubes, reference.mesh(), mesh.stretch(), limit, options.threads);
        by_cubes.reset();
        return_freed_memory();
        const CellIndex index = index_by_boxes(input, reference.cells());
        const IndexedMesh<Real> whole{input, reference.cells(), index, kBoxBits, 0};
        tally = contract_boxes(whole, &witnesses, reference, limit, options, parts);
    }
    return_freed_memory();
    mesh.take(input, reference.mesh(), parts);
    return_freed_memory();
    return tally;
}

template Tally contract_apart(const MeshArrays<float>&, const Reference<float>&, std::optional<CellIndex>, float,
                              const Options&, Mesh<float>&);
template Tally contract_apart(const MeshArrays<double>&, const Reference<double>&, std::optional<CellIndex>, float,
                              const Options&, Mesh<double>&);

}  // namespace isocore::simplification
