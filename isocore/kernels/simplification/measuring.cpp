#include "simplification/measuring.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "common/facets.hpp"
#include "common/parallel.hpp"

namespace isocore::simplification {
namespace {

void add(const SheetFacts& found, auto& to) {
    to.unproved += found.unproved;
    to.error.add(found.error);
    to.other.add(found.other);
    to.back_max = std::max(to.back_max, found.back_max);
}

// Of some triangles: what was found, sheet by sheet.
using BySheet = std::vector<std::pair<std::uint32_t, SheetFacts>>;

SheetFacts& of_sheet(std::uint32_t sheet, BySheet& all) {
    const auto known = std::find_if(all.begin(), all.end(), [&](const auto& one) { return one.first == sheet; });
    if (known != all.end()) return known->second;
    return all.emplace_back(sheet, SheetFacts{}).second;
}

template <class Real>
class Measuring {
  public:
    Measuring(Mesh<Real>& mesh, Backward<Real>& prover, float limit, const Spot& other)
        : mesh_(mesh), prover_(prover), limit_(limit), other_(other), is_one_unit_(other == mesh.stretch()) {}

    void measure(std::int32_t number, SheetFacts& out) {
        const Triangle& triangle = mesh_.triangles[static_cast<std::size_t>(number)];
        float& proved = mesh_.proved[static_cast<std::size_t>(number)];
        constexpr float kMargin = 1e-5f;
        if (std::isinf(proved) && prover_.is_provable(limit_)) proved = prover_.distance(number, limit_ - kMargin);
        if (std::isinf(proved))
            ++out.unproved;
        else
            out.back_max = std::max(out.back_max, static_cast<double>(proved));
        const Deviation error = deviation(triangle, mesh_.stretch());
        out.error.add(error);
        out.other.add(is_one_unit_ ? error : deviation(triangle, other_));
    }

  private:
    // Of the triangle's witnesses.
    Deviation deviation(const Triangle& triangle, const Spot& stretch) {
        Deviation sum;
        if (triangle.witness == kNone) return sum;
        const auto& origin = mesh_.places[static_cast<std::size_t>(triangle.corners[0])].at;
        const auto place = [&](std::int32_t number) {
            const auto at = mesh_.place_of(number);
            Spot out;
            for (std::size_t a = 0; a < 3; ++a) out[a] = static_cast<float>(at[a] - origin[a]) * stretch[a];
            return out;
        };
        facet_.clear();
        facet_.add({0, 0, 0}, place(triangle.corners[1]), place(triangle.corners[2]));
        facet_.find_frames();
        for (std::int32_t w = triangle.witness; w != kNone; w = mesh_.next(w)) {
            const Spot at = place(w);
            const auto squared = static_cast<double>(facet_.from_points(0, {at[0], at[1], at[2]}).first());
            if (!(squared >= 0)) continue;  // a triangle without an area
            sum.add({std::sqrt(squared), std::sqrt(squared), squared});
        }
        return sum;
    }

    Mesh<Real>& mesh_;
    Backward<Real>& prover_;
    float limit_;
    const Spot& other_;
    bool is_one_unit_;
    Facets facet_;
};

}  // namespace

template <class Real>
void measure(Mesh<Real>& mesh, const std::vector<Backward<Real>*>& provers, float limit, const Spot& other,
             Facts& facts) {
    std::vector<BySheet> found(mesh.lot_count());
    std::atomic<std::size_t> taken{0};
    const auto with_prover = [&] { return Measuring<Real>(mesh, *provers[taken++], limit, other); };
    const auto measure_some = [&](Measuring<Real>& measuring, std::size_t some) {
        const auto [first, end] = mesh.lot(some);
        for (std::size_t t = first; t < end; ++t) {
            if (mesh.triangles[t].is_gone()) continue;
            const auto number = static_cast<std::int32_t>(t);
            measuring.measure(number, of_sheet(mesh.sheet_of(number), found[some]));
        }
    };
    parallel_for(static_cast<int>(provers.size()), found.size(), with_prover, measure_some);
    // In their order: sums of floating-point numbers depend on it.
    for (const BySheet& some : found) {
        for (const auto& [sheet, of_it] : some) {
            add(of_it, facts);
            if (mesh.has_sheets()) add(of_it, facts.sheets[sheet]);
        }
    }
}

template void measure(Mesh<float>&, const std::vector<Backward<float>*>&, float, const Spot&, Facts&);
template void measure(Mesh<double>&, const std::vector<Backward<double>*>&, float, const Spot&, Facts&);

}  // namespace isocore::simplification
