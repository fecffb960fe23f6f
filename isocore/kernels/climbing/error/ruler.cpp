#include "climbing/error/ruler.hpp"

#include <algorithm>
#include <cmath>

namespace isocore::climbing {
namespace {

constexpr Spot kNoStretch{1, 1, 1};
constexpr std::size_t kWorthwhile = 96;  // so many triangles are measured at once
static_assert(Facets::kRoom >= BoxEdges::kMostOfBox);

}  // namespace

Ruler::Ruler(const SampleReader& samples, const Options& options)
    : options_(options), unit_(*std::max_element(options.spacing.begin(), options.spacing.end())), spotter_(samples) {
    for (std::size_t a = 0; a < 3; ++a) stretch_[a] = static_cast<float>(options.spacing[a] / unit_);
    if (stretch_ != kNoStretch) world_ = std::make_unique<Measured>();
    // The largest float that is not above the bound: rounding must not loosen it.
    const double unit = options.in_world ? unit_ : 1;
    limit_ = static_cast<float>(options.max_error / unit);
    while (static_cast<double>(limit_) * unit > options.max_error) limit_ = std::nextafter(limit_, 0.0f);
}

void Ruler::place(const Dims& origin, const BoxEdges& edges) {
    std::size_t placed = 0;
    const auto store = [&](const Vector<Floats>& places, std::size_t at) {
        for (std::size_t a = 0; a < 3; ++a) {
            places[a].store(voxels_.places[a].data() + at);
            if (world_) (places[a] * stretch_[a]).store(world_->places[a].data() + at);
        }
    };
    const auto place_added = [&] {
        const std::size_t start = placed;
        spotter_.visit(origin, kNoStretch,
                       [&](const Vector<Floats>& places, const Floats&, std::size_t first, std::size_t count) {
                           store(places, start + first);
                           placed += count;
                       });
    };
    for (const BoxEdge& found : edges.dropped()) {
        spotter_.add(found.edge(), edges.box(found.box()).low);
        if (spotter_.full()) place_added();
    }
    place_added();
}

void Ruler::begin_box(std::size_t number, std::size_t first, std::size_t count, std::size_t triangles, Bar& bar) {
    if (voxels_.facets.size() + triangles > Facets::kRoom || crossings_ + count > BoxEdges::kMostEdges) measure(bar);
    boxes_.push_back({number, triangles, first, count});
    crossings_ += count;
}

void Ruler::end_box(Bar& bar) {
    if (voxels_.facets.size() > kWorthwhile) measure(bar);
}

void Ruler::measure(Bar& bar) {
    Bar* const judged = std::isfinite(limit_) ? &bar : nullptr;
    measure(voxels_, !world_ || !options_.in_world ? judged : nullptr);
    if (world_) measure(*world_, options_.in_world ? judged : nullptr);
    boxes_.clear();
    crossings_ = 0;
}

// Measures all waiting boxes in one unit of length. bar: where boxes that break the bound are noted, or null.
void Ruler::measure(Measured& measured, Bar* bar) {
    auto& [tally, facets, places] = measured;
    facets.find_frames();
    std::size_t triangle = 0, crossing = 0;
    for (const WaitingBox& box : boxes_) {
        float* const squared = squared_.data() + crossing;
        const Vector<const float*> points{places[0].data() + box.first, places[1].data() + box.first,
                                          places[2].data() + box.first};
        facets.squared_distances(triangle, box.triangles, points, box.crossings, squared);
        if (bar && std::sqrt(*std::max_element(squared, squared + box.crossings)) > limit_)
            bar->broken.push_back(box.number);
        triangle += box.triangles;
        crossing += box.crossings;
    }
    for (std::size_t n = 0; n < crossing; n += kLanes) {
        const Floats squared = first_lanes(Floats(squared_.data() + n), std::min(kLanes, crossing - n), 0.0f);
        tally.add(root(squared), squared);
    }
    facets.clear();
}

void Ruler::take(Bar& bar) {
    isocore::climbing::add(bar.in_voxels, voxels_.tally.sum_up(1));
    isocore::climbing::add(bar.in_world, (world_ ? *world_ : voxels_).tally.sum_up(unit_));
    voxels_.tally = {};
    if (world_) world_->tally = {};
}

}  // namespace isocore::climbing
