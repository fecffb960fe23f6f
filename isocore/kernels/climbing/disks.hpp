// disks.hpp - Draws the highrices of several cells, each as a disk through its edge loop, many at a time, and has them
// measured.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <tuple>
#include <utility>

#include "climbing/boxes/halvings.hpp"
#include "climbing/error/ruler.hpp"
#include "climbing/triangles/box_edges.hpp"
#include "climbing/triangles/drawn_site.hpp"
#include "climbing/triangles/edge_loops.hpp"
#include "climbing/triangles/placed_vertices.hpp"
#include "climbing/triangles/polygon.hpp"
#include "climbing/triangles/polygons.hpp"
#include "climbing/triangles/triangle_list.hpp"
#include "climbing/types.hpp"

namespace isocore::climbing {

class Disks {
  public:
    Disks(const SampleReader& samples, const SignGrid& signs, const Options& options, const PlacedVertices& vertices)
        : signs_(signs), options_(options), vertices_(vertices), edges_(options.block_size), ruler_(samples, options) {}

    // Before the first block of a bar.
    void begin_bar() { drawn_ = 0; }

    // Those of the block that the site has loaded; blocks come in their order in the bar. Triangles of shorter loops
    // come first.
    void draw(const DrawnSite& site, std::span<const Piece> pieces, TriangleList& out, Bar& bar) {
        for (const Piece& piece : pieces) {
            const HighRice box = piece.within(site.cells);
            if (!edges_.has_room(box)) draw_added(site, out, bar);
            edges_.add(site, box);
        }
        if (edges_.size() > 0) draw_added(site, out, bar);
    }

    // After its last block: notes what was measured, and which boxes break the bound.
    void end_bar(Bar& bar) {
        if (options_.measured) ruler_.take(bar);
        std::sort(bar.broken.begin(), bar.broken.end());
    }

  private:
    template <std::size_t... n>
    static std::tuple<Polygons<n + 3>...> all_polygons(std::index_sequence<n...>);

    // Draws the boxes whose edges were added.
    void draw_added(const DrawnSite& site, TriangleList& out, Bar& bar) {
        edges_.find();
        loops_.arrange(edges_, site);
        if (options_.measured) ruler_.place(site.origin, edges_);
        sizes_ = {};
        for (std::size_t n = 0; n < edges_.size(); ++n) {
            const std::size_t list = std::min(edges_.first_kept(n + 1) - edges_.first_kept(n), kLongestOfSeveral + 1);
            by_length_[list][sizes_[list]++] = static_cast<std::uint8_t>(n);
        }
        [&]<std::size_t... n>(std::index_sequence<n...>) {
            (draw_short<n + 3>(site, out, bar), ...);
        }(std::make_index_sequence<kLongestOfSeveral - 2>{});
        for (std::size_t n = 0; n < sizes_[kLongestOfSeveral + 1]; ++n)
            draw_long(site, by_length_[kLongestOfSeveral + 1][n], out, bar);
        if (options_.measured) ruler_.measure(bar);
        drawn_ += edges_.size();
        edges_.clear();
    }

    // Has a box measured if there is anything to measure; visit(add) adds its triangles.
    template <class Visit>
    void measure(std::size_t box, std::size_t triangles, Bar& bar, const Visit& visit) {
        const std::size_t first = edges_.first_dropped(box), count = edges_.first_dropped(box + 1) - first;
        if (!options_.measured || count == 0) return;
        ruler_.begin_box(drawn_ + box, first, count, triangles, bar);
        visit([&](const Spot& a, const Spot& b, const Spot& c) { ruler_.add(a, b, c); });
        ruler_.end_box(bar);
    }

    // Where numbers of a box are small when taken from.
    Vector<double> origin(const DrawnSite& site, std::size_t box) const {
        Vector<double> out;
        for (std::size_t a = 0; a < 3; ++a)
            out[a] = static_cast<double>(site.origin[a] + edges_.box(box).low[a]) - static_cast<double>(signs_.pad);
        return out;
    }

    // Calls set(place, faces, vertex) for the n-th of all kept edges.
    template <class Set>
    void set_corner(const DrawnSite& site, std::size_t n, const Vector<double>& origin, const Set& set) const {
        const Edge edge = edges_.kept()[n].edge();
        const std::int32_t number = site.vertex(edge.axis(), edge.at());
        set(vertices_.from(origin, static_cast<std::size_t>(number)), loops_.faces(n), number);
    }

    template <std::size_t length>
    void draw_short(const DrawnSite& site, TriangleList& out, Bar& bar) {
        Polygons<length>& polygons = std::get<length - 3>(polygons_);
        constexpr std::size_t kCount = Polygons<length>::kCount;
        const std::span<const std::uint8_t> boxes(by_length_[length].data(), sizes_[length]);
        for (std::size_t start = 0; start < boxes.size(); start += kCount) {
            const std::size_t count = std::min(boxes.size() - start, kCount);
            const auto ranks = rank<length>(boxes.subspan(start, count));
            for (std::size_t n = 0; n < count; ++n) {
                const std::size_t box = boxes[start + n], first = edges_.first_kept(box);
                const auto from = origin(site, box);
                for (std::size_t e = 0; e < length; ++e) {
                    set_corner(site, first + e, from, [&](const Spot& place, unsigned faces, std::int32_t vertex) {
                        polygons.set(n, static_cast<std::size_t>(ranks[e][n]), place, faces, vertex);
                    });
                }
            }
            polygons.triangulate(count);
            std::int32_t* vertices = out.reserve(count * polygons.kTriangles);
            for (std::size_t n = 0; n < count; ++n) {
                const auto triangles = polygons.triangles(n);
                for (const auto& triangle : triangles) {
                    for (const std::size_t corner : triangle) *vertices++ = polygons.vertex(n, corner);
                }
                measure(boxes[start + n], polygons.kTriangles, bar, [&](auto add) {
                    for (const auto& [a, b, c] : triangles)
                        add(polygons.place(n, a), polygons.place(n, b), polygons.place(n, c));
                });
            }
            out.end_at(vertices);
        }
    }

    // The places of kept edges in their loops: by edge, and by box.
    template <std::size_t length>
    std::array<std::array<float, kLanes<float>>, length> rank(std::span<const std::uint8_t> boxes) const {
        std::array<std::array<float, kLanes<float>>, length> out{};
        for (std::size_t n = 0; n < boxes.size(); ++n) {
            const std::size_t first = edges_.first_kept(boxes[n]);
            for (std::size_t e = 0; e < length; ++e) out[e][n] = loops_.place(first + e);
        }
        std::array<Numbers, length> places;
        for (std::size_t e = 0; e < length; ++e) places[e] = Numbers(out[e].data());
        const Numbers zero(0.0f), one(1.0f);
        for (std::size_t e = 0; e < length; ++e) {
            Numbers before = zero;
            for (std::size_t other = 0; other < length; ++other) {
                if (other != e) before = before + choose(places[other] < places[e], one, zero);
            }
            before.store(out[e].data());
        }
        return out;
    }

    void draw_long(const DrawnSite& site, std::size_t box, TriangleList& out, Bar& bar) {
        const std::size_t first = edges_.first_kept(box), size = edges_.first_kept(box + 1) - first;
        const auto from = origin(site, box);
        polygon_.resize(size);
        for (std::size_t e = 0; e < size; ++e)
            order_[e] = {loops_.place(first + e), static_cast<std::uint32_t>(first + e)};
        std::sort(order_.begin(), order_.begin() + static_cast<std::ptrdiff_t>(size));
        for (std::size_t e = 0; e < size; ++e) {
            set_corner(site, order_[e].second, from, [&](const Spot& place, unsigned faces, std::int32_t vertex) {
                polygon_.set(e, place, faces, vertex);
            });
        }
        const auto triangles = polygon_.triangulate();
        std::int32_t* vertices = out.reserve(triangles.size());
        for (const auto& triangle : triangles) {
            for (const std::size_t corner : triangle) *vertices++ = polygon_.vertex(corner);
        }
        out.end_at(vertices);
        measure(box, triangles.size(), bar, [&](auto add) {
            for (const auto& [a, b, c] : triangles) add(polygon_.place(a), polygon_.place(b), polygon_.place(c));
        });
    }

    const SignGrid& signs_;
    const Options& options_;
    PlacedVertices vertices_;
    BoxEdges edges_;
    EdgeLoops loops_;
    std::array<std::array<std::uint8_t, BoxEdges::kMostBoxes>, kLongestOfSeveral + 2> by_length_;  // boxes
    std::array<std::size_t, kLongestOfSeveral + 2> sizes_;                                         // of these lists
    decltype(all_polygons(std::make_index_sequence<kLongestOfSeveral - 2>{})) polygons_;
    Polygon polygon_;
    std::array<std::pair<float, std::uint32_t>, BoxEdges::kMostOfBox> order_;
    Ruler ruler_;
    std::size_t drawn_ = 0;  // boxes of the bar
};

}  // namespace isocore::climbing
