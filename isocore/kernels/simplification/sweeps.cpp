#include "simplification/sweeps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/prefetch.hpp"

namespace isocore::simplification {
namespace {

constexpr std::size_t kAhead = 4;  // vertices
constexpr float kInfinity = std::numeric_limits<float>::infinity();
// An edge is not tried where the planes of both ends lie further away than so many bounds, in the root mean square over
// their areas. The rules would allow few of these, and their large faces take the longest to prove.
constexpr float kHopeless = 0.8f;
constexpr float kLeastBound = 1e-3f;  // cells: so that a bound of 0 leaves room for rounding

template <class Real>
class Sweep {
  public:
    Sweep(Mesh<Real>& mesh, Contraction<Real>& contraction, std::vector<float>& costs)
        : mesh_(mesh), contraction_(contraction), costs_(costs) {
        const float most = kHopeless * std::max(contraction.limit(), kLeastBound);
        most_squared_ = most * most;
    }

    // The least of the costs of edges from the ring's centre that did not fail yet, and which; infinity if there is
    // none.
    float find_cheapest() {
        const std::uint64_t failed = mesh_.vertices[static_cast<std::size_t>(ring_.centre)].failed;
        float best = kInfinity;
        for (std::size_t n = 0; n < ring_.count; ++n) {
            if (failed >> n & 1 || !(each_[n] < best)) continue;
            best = each_[n];
            cheapest_ = n;
        }
        return best;
    }

    // Asks for what is known of a vertex ahead of its turn.
    void fetch(std::int32_t vertex) const {
        const Vertex& next = mesh_.vertices[static_cast<std::size_t>(vertex)];
        for (std::size_t n = 0; n < next.count; ++n) ISOCORE_PREFETCH(mesh_.triangles.data() + next.ring[n]);
    }

    void look_at(std::int32_t vertex) {
        if (mesh_.vertices[static_cast<std::size_t>(vertex)].on_curve)
            ring_.gather_ends(mesh_, vertex);
        else
            ring_.gather(mesh_, vertex);
        const Quadric& quadric = *mesh_.quadrics[static_cast<std::size_t>(vertex)];
        for (std::size_t n = 0; n < ring_.count; n += kLanes) quadric.at(ring_.in_lanes(n)).store(each_.data() + n);
        for (std::size_t n = 0; n < ring_.count; ++n) {
            const auto to = static_cast<std::size_t>(ring_.neighbours[n]);
            each_[n] = std::max(0.0f, each_[n]) + mesh_.quadrics[to]->constant();
            if (each_[n] > most_squared_ * (quadric.area() + mesh_.quadrics[to]->area())) each_[n] = kInfinity;
        }
    }

    // Contracts an edge from this vertex that costs no more than the limit, if one can be. Else its cost is then that
    // of the cheapest edge not tried yet.
    bool try_vertex(std::int32_t number, float limit) {
        look_at(number);
        Vertex& vertex = mesh_.vertices[static_cast<std::size_t>(number)];
        float cost = find_cheapest();
        for (; cost <= limit && cost < kInfinity; cost = find_cheapest()) {
            if (contraction_.contract(ring_, cheapest_)) {
                wake_neighbours();
                return true;
            }
            vertex.failed |= std::uint64_t{1} << cheapest_;
        }
        costs_[static_cast<std::size_t>(number)] = cost;
        return false;
    }

  private:
    void wake_neighbours() {
        const Star& first = contraction_.star(0);
        costs_[static_cast<std::size_t>(first.centre)] = kInfinity;
        const auto target = static_cast<std::size_t>(first.target());
        if (mesh_.vertices[target].movable) costs_[target] = 0;
        const bool along_curve = contraction_.star_count() > 1;
        for (std::size_t part = 0; part < contraction_.star_count(); ++part) {
            const Star& star = contraction_.star(part);
            for (std::size_t n = 1; n < star.count; ++n) {
                const std::int32_t number = star.neighbours[n];
                const Vertex& other = mesh_.vertices[static_cast<std::size_t>(number)];
                if (other.movable && (!other.on_curve || (along_curve && number == star.other_end())))
                    wake(static_cast<std::size_t>(number), target);
            }
        }
    }

    void wake(std::size_t other, std::size_t target) {
        const Spot way = mesh_.relative(mesh_.places[target].at, mesh_.places[other].at);
        const float cost = std::max(0.0f, mesh_.quadrics[other]->at(way)) + mesh_.quadrics[target]->constant();
        costs_[other] = std::min(costs_[other], cost);
    }

    Mesh<Real>& mesh_;
    Contraction<Real>& contraction_;
    std::vector<float>& costs_;
    float most_squared_;
    Ring ring_;
    std::array<float, Ring::kRoom> each_;
    std::size_t cheapest_ = 0;
};

}  // namespace

template <class Real>
void sweep(const std::vector<std::int32_t>& vertices, Mesh<Real>& mesh, Contraction<Real>& contraction,
           std::vector<float>& costs, std::size_t most) {
    contraction.make_quadrics(vertices);
    Sweep<Real> sweep(mesh, contraction, costs);
    for (const std::int32_t v : vertices) {
        sweep.look_at(v);
        costs[static_cast<std::size_t>(v)] = sweep.find_cheapest();
    }
    constexpr float kFirst = 1e-6f;
    constexpr int kWider = 3;
    const bool is_wide = most == std::numeric_limits<std::size_t>::max();
    while (most > 0) {
        float cheapest = kInfinity;
        for (const std::int32_t v : vertices) cheapest = std::min(cheapest, costs[static_cast<std::size_t>(v)]);
        if (cheapest == kInfinity) return;
        int exponent = 0;
        std::frexp(std::max(cheapest, kFirst), &exponent);
        // The next power of two above, or one further on. Where a number of triangles is asked for, it is the order
        // that keeps the error small.
        const float limit = std::ldexp(1.0f, exponent + (is_wide ? kWider : 0));
        bool is_done = false;
        while (!is_done && most > 0) {
            is_done = true;
            for (std::size_t n = 0; n < vertices.size(); ++n) {
                const std::int32_t v = vertices[n];
                if (costs[static_cast<std::size_t>(v)] > limit) continue;
                if (n + kAhead < vertices.size()) sweep.fetch(vertices[n + kAhead]);
                if (sweep.try_vertex(v, limit)) --most;
                is_done = false;
                if (most == 0) break;
            }
        }
    }
}

template void sweep(const std::vector<std::int32_t>&, Mesh<float>&, Contraction<float>&, std::vector<float>&,
                    std::size_t);
template void sweep(const std::vector<std::int32_t>&, Mesh<double>&, Contraction<double>&, std::vector<float>&,
                    std::size_t);

}  // namespace isocore::simplification
