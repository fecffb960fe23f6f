#include "climbing/disks.hpp"

#include <algorithm>

namespace isocore::climbing {

Disks::Disks(const SampleReader& samples, const SignGrid& signs, const Options& options, const PlacedVertices& vertices)
    : signs_(signs), options_(options), vertices_(vertices), edges_(options.block_size), ruler_(samples, options) {}

void Disks::draw(const DrawnSite& site, std::span<const Piece> boxes, TriangleList& out, Bar& bar) {
    for (const Piece& piece : boxes) {
        const HighRice box = piece.within(site.cells);
        if (!edges_.has_room(box)) draw_added(site, out, bar);
        edges_.add(site, box);
    }
    if (edges_.size() > 0) draw_added(site, out, bar);
}

void Disks::end_bar(Bar& bar) {
    if (options_.measured) ruler_.take(bar);
    std::sort(bar.broken.begin(), bar.broken.end());
}

// Draws the boxes whose edges were added, and forgets them.
void Disks::draw_added(const DrawnSite& site, TriangleList& out, Bar& bar) {
    edges_.find();
    loops_.arrange(edges_, site);
    if (options_.measured) ruler_.place(site.origin, edges_);
    sort_by_length();
    [&]<std::size_t... n>(std::index_sequence<n...>) {
        (draw_short<n + 3>(site, out, bar), ...);
    }(std::make_index_sequence<kLongestOfSeveral - 2>{});
    for (std::size_t n = 0; n < sizes_[kLongestOfSeveral + 1]; ++n)
        draw_long(site, by_length_[kLongestOfSeveral + 1][n], out, bar);
    if (options_.measured) ruler_.measure(bar);
    drawn_ += edges_.size();
    edges_.clear();
}

void Disks::sort_by_length() {
    sizes_ = {};
    for (std::size_t n = 0; n < edges_.size(); ++n) {
        const std::size_t list = std::min(edges_.first_kept(n + 1) - edges_.first_kept(n), kLongestOfSeveral + 1);
        by_length_[list][sizes_[list]++] = static_cast<std::uint8_t>(n);
    }
}

// Draws the boxes whose loops have this length, eight at a time.
template <std::size_t length>
void Disks::draw_short(const DrawnSite& site, TriangleList& out, Bar& bar) {
    Polygons<length>& polygons = std::get<length - 3>(polygons_);
    constexpr std::size_t kCount = Polygons<length>::kCount;
    const std::span<const std::uint8_t> boxes(by_length_[length].data(), sizes_[length]);
    for (std::size_t start = 0; start < boxes.size(); start += kCount) {
        const std::size_t count = std::min(boxes.size() - start, kCount);
        fill(polygons, site, boxes.subspan(start, count));
        polygons.triangulate(count, vertices_.have_directions());
        std::int32_t* vertices = out.reserve(count * polygons.kTriangles);
        for (std::size_t n = 0; n < count; ++n) {
            const auto triangles = polygons.triangles(n);
            for (const auto& triangle : triangles) {
                for (const std::size_t corner : triangle) *vertices++ = polygons.vertex(n, corner);
            }
            measure(boxes[start + n], polygons.kTriangles, bar, [&](const auto& add) {
                for (const auto& [a, b, c] : triangles)
                    add(polygons.place(n, a), polygons.place(n, b), polygons.place(n, c));
            });
        }
        out.end_at(vertices);
    }
}

// Sets the corners of some boxes' loops, in the order of each loop.
template <std::size_t length>
void Disks::fill(Polygons<length>& polygons, const DrawnSite& site, std::span<const std::uint8_t> boxes) const {
    const auto ranks = rank<length>(boxes);
    for (std::size_t n = 0; n < boxes.size(); ++n) {
        const std::size_t first = edges_.first_kept(boxes[n]);
        const auto from = origin(site, boxes[n]);
        for (std::size_t e = 0; e < length; ++e) {
            set_corner(site, first + e, from, [&](const Spot& place, unsigned faces, std::int32_t vertex) {
                const auto corner = static_cast<std::size_t>(ranks[e][n]);
                polygons.set(n, corner, place, faces, vertex);
                if (vertices_.have_directions()) polygons.set_direction(n, corner, vertices_.direction(vertex));
            });
        }
    }
}

// Sorts the kept edges of up to eight boxes along their loops, by counting: an edge's rank is how many edges of its box
// come before it. Comparisons are made for all boxes at once, and no branch depends on them.
// The result is by edge, then by box.
template <std::size_t length>
auto Disks::rank(std::span<const std::uint8_t> boxes) const -> std::array<LoopRanks, length> {
    std::array<LoopRanks, length> out{};
    for (std::size_t n = 0; n < boxes.size(); ++n) {
        const std::size_t first = edges_.first_kept(boxes[n]);
        for (std::size_t e = 0; e < length; ++e) out[e][n] = loops_.place(first + e);
    }
    using Floats = Floats;
    std::array<Floats, length> places;
    for (std::size_t e = 0; e < length; ++e) places[e] = Floats(out[e].data());
    const Floats zero(0.0f), one(1.0f);
    for (std::size_t e = 0; e < length; ++e) {
        Floats before = zero;
        for (std::size_t other = 0; other < length; ++other) {
            if (other != e) before = before + choose(places[other] < places[e], one, zero);
        }
        before.store(out[e].data());
    }
    return out;
}

// Draws one box, whose loop may have any length.
void Disks::draw_long(const DrawnSite& site, std::size_t box, TriangleList& out, Bar& bar) {
    const std::size_t first = edges_.first_kept(box), size = edges_.first_kept(box + 1) - first;
    const auto from = origin(site, box);
    polygon_.resize(size);
    for (std::size_t e = 0; e < size; ++e) order_[e] = {loops_.place(first + e), static_cast<std::uint32_t>(first + e)};
    std::sort(order_.begin(), order_.begin() + static_cast<std::ptrdiff_t>(size));
    for (std::size_t e = 0; e < size; ++e) {
        set_corner(site, order_[e].second, from, [&](const Spot& place, unsigned faces, std::int32_t vertex) {
            polygon_.set(e, place, faces, vertex);
            if (vertices_.have_directions()) polygon_.set_direction(e, vertices_.direction(vertex));
        });
    }
    const auto triangles = polygon_.triangulate(vertices_.have_directions());
    std::int32_t* vertices = out.reserve(triangles.size());
    for (const auto& triangle : triangles) {
        for (const std::size_t corner : triangle) *vertices++ = polygon_.vertex(corner);
    }
    out.end_at(vertices);
    measure(box, triangles.size(), bar, [&](const auto& add) {
        for (const auto& [a, b, c] : triangles) add(polygon_.place(a), polygon_.place(b), polygon_.place(c));
    });
}

// The box's low end, in the mesh's coordinates. It is subtracted from the places of the box's vertices, so that float32
// keeps its precision.
Vector<double> Disks::origin(const DrawnSite& site, std::size_t box) const {
    Vector<double> out;
    for (std::size_t a = 0; a < 3; ++a)
        out[a] = static_cast<double>(site.origin[a] + edges_.box(box).low[a]) - static_cast<double>(signs_.pad);
    return out;
}

// Calls set(place, faces, vertex) for edge n of edges_.kept(); the place is relative to `origin`.
template <class Set>
void Disks::set_corner(const DrawnSite& site, std::size_t n, const Vector<double>& origin, const Set& set) const {
    const Edge edge = edges_.kept()[n].edge();
    const std::int32_t number = site.vertex(edge.axis(), edge.at());
    set(vertices_.from(origin, static_cast<std::size_t>(number)), loops_.faces(n), number);
}

// Has a box measured if it has dropped edges. visit(add) is to call add(a, b, c) for each of its triangles.
template <class Visit>
void Disks::measure(std::size_t box, std::size_t triangles, Bar& bar, const Visit& visit) {
    const std::size_t first = edges_.first_dropped(box), count = edges_.first_dropped(box + 1) - first;
    if (!options_.measured || count == 0) return;
    ruler_.begin_box(drawn_ + box, first, count, triangles, bar);
    visit([&](const Spot& a, const Spot& b, const Spot& c) { ruler_.add(a, b, c); });
    ruler_.end_box(bar);
}

}  // namespace isocore::climbing
