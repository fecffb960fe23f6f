// edge_vertices.hpp - Smoothing of the vertices of grid edges.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "common/large_pages.hpp"
#include "common/parallel.hpp"
#include "labels/shape.hpp"
#include "labels/sliding.hpp"

namespace isocore::labels {

// The vertices of grid edges, which slide along them, with their rings of neighbours. They are sorted by the size of
// their ring, block by block, so that loops over a ring have one length many times over. Way: holds the difference of
// any two neighbours' numbers.
template <class Way>
class EdgeVertices {
  public:
    // place: room for a number of each vertex.
    EdgeVertices(const Shape& shape, Array<std::uint32_t> place)
        : triangles_(shape.triangles), ends_(find_ends(shape)), place_(std::move(place)) {
        std::vector<std::uint8_t> sizes(shape.elements.size(), 0);
        for (const std::int32_t corner : shape.triangles) ++sizes[static_cast<std::size_t>(corner)];
        for (std::size_t v = 0; v < ends_.size(); ++v)
            sizes[v] = static_cast<std::uint8_t>(sizes[v] + (ends_[v] != kNone));
        order(shape, sizes);
    }

    // What the first step needs besides: each vertex's neighbours.
    void find_neighbours(const Shape& shape, int threads) {
        shares_ = find_shares(shape, threads);
        ring_ = large_array<Way>(ring_size_);
        fill(std::move(place_), threads);
        normal_ = large_array<Lanes>(shape.elements.size());
    }

    std::size_t blocks() const { return blocks_.size() - 1; }

    // A vertex' sum has one order, whoever adds it up.
    void renew_normals(const Places& from, int threads) {
        parallel_for(threads, shares_.size(), [&](std::size_t n) { sum_areas(from, shares_[n]); });
    }

    // Moves those of a block by one step, from their places in `from` to those in `to`.
    void step(std::size_t block, const Places& from, Places& to, float factor, bool new_normals) {
        // Nearly all rings have three to eight neighbours: loops of a length that the compiler knows.
        using Self = EdgeVertices<Way>;
        constexpr std::array kMoves{&Self::move<0>, &Self::move<0>, &Self::move<0>, &Self::move<3>, &Self::move<4>,
                                    &Self::move<5>, &Self::move<6>, &Self::move<7>, &Self::move<8>};
        for (std::size_t n = blocks_[block]; n < blocks_[block + 1]; ++n) {
            if (new_normals) set_normals(runs_[n]);
            const std::size_t known = runs_[n].ring < kMoves.size() ? runs_[n].ring : 0;
            (this->*kMoves[known])(runs_[n], from, to, factor);
        }
    }

  private:
    // Vertices `begin` to `end` of vertex_, whose rings have `ring` neighbours each, from ring_[first] on.
    struct Run {
        std::size_t begin, end, first, ring;
    };

    // Finds where the ring of each vertex begins, or kNone.
    void order(const Shape& mesh, const std::vector<std::uint8_t>& sizes) {
        std::size_t first = 0;
        vertex_.reserve(sizes.size());
        std::array<std::vector<std::uint32_t>, 256> of_size;
        for (std::size_t begin = 0; begin < sizes.size(); begin += kBlock) {
            blocks_.push_back(runs_.size());
            const std::size_t end = std::min(sizes.size(), begin + kBlock);
            for (std::size_t v = begin; v < end; ++v) {
                if (is_edge(mesh.elements[v])) of_size[sizes[v]].push_back(static_cast<std::uint32_t>(v));
            }
            for (std::size_t ring = 0; ring < of_size.size(); ++ring) {
                if (of_size[ring].empty()) continue;
                runs_.push_back({vertex_.size(), vertex_.size() + of_size[ring].size(), first, ring});
                first += ring * of_size[ring].size();
                vertex_.insert(vertex_.end(), of_size[ring].begin(), of_size[ring].end());
                of_size[ring].clear();
            }
        }
        blocks_.push_back(runs_.size());
        ring_size_ = first;
        axis_.reserve(vertex_.size());
        for (const std::uint32_t v : vertex_) axis_.push_back(static_cast<std::uint8_t>(mesh.elements[v] / 2));
        std::fill(place_.begin(), place_.end(), kNone);
        for (const Run& run : runs_) {
            for (std::size_t n = run.begin; n < run.end; ++n) {
                place_[vertex_[n]] = static_cast<std::uint32_t>(run.first + (n - run.begin) * run.ring);
            }
        }
    }

    // Each triangle at a vertex gives it the two others; as a ring closes, each neighbour comes first exactly once.
    void fill(Array<std::uint32_t> place, int threads) {
        parallel_for(threads, shares_.size(), [&](std::size_t number) {
            const Share& share = shares_[number];
            for (std::size_t t = 3 * share.first; t < 3 * share.last; t += 3) {
                for (std::size_t n = 0; n < 3; ++n) {
                    const auto v = static_cast<std::size_t>(triangles_[t + n]);
                    if (!share.holds(triangles_[t + n]) || place[v] == kNone) continue;
                    ring_[place[v]++] = static_cast<Way>(triangles_[t + (n + 1) % 3] - triangles_[t + n]);
                }
            }
            for (std::size_t v = share.begin; v < share.end && !ends_.empty(); ++v) {
                if (place[v] != kNone && ends_[v] != kNone)
                    ring_[place[v]] =
                        static_cast<Way>(static_cast<std::int32_t>(ends_[v]) - static_cast<std::int32_t>(v));
            }
        });
    }

    // Twice the area vector of all triangles at a vertex, for those of a share.
    void sum_areas(const Places& from, const Share& share) {
        std::fill(normal_.begin() + static_cast<std::ptrdiff_t>(share.begin),
                  normal_.begin() + static_cast<std::ptrdiff_t>(share.end), Lanes{});
        for (std::size_t t = 3 * share.first; t < 3 * share.last; t += 3) {
            const std::int32_t* corners = triangles_.data() + t;
            const std::array here{share.holds(corners[0]), share.holds(corners[1]), share.holds(corners[2])};
            if (!here[0] && !here[1] && !here[2]) continue;
            const auto place = [&](std::size_t n) -> const Lanes& {
                return from[static_cast<std::size_t>(corners[n])];
            };
            const Lanes area = cross(place(1) - place(0), place(2) - place(0));
            for (std::size_t n = 0; n < 3; ++n) {
                if (here[n]) normal_[static_cast<std::size_t>(corners[n])] += area;
            }
        }
    }

    void set_normals(const Run& run) {
        for (std::size_t n = run.begin; n < run.end; ++n) {
            Lanes& normal = normal_[vertex_[n]];
            const float length = std::sqrt(dot(normal, normal));
            const float share = length > 0 ? 1 / (length * steep(normal[axis_[n]] / length)) : 0;
            normal = share * normal;
        }
    }

    // To where the plane through the smoothed place, with the vertex's normal, meets the edge. `known` is the number of
    // neighbours, or 0.
    template <std::size_t known>
    void move(const Run& run, const Places& from, Places& to, float factor) const {
        const std::size_t ring = known == 0 ? run.ring : known;
        const float share = 1 / static_cast<float>(ring);
        const Way* way = ring_.data() + run.first;
        // Where a vertex is, and how far the mean of its neighbours lies above its plane: the terms of a sum.
        const auto look = [&](std::size_t n, float& at) {
            Lanes sum{};
            const Lanes* const own = from.data() + vertex_[n];
            for (std::size_t m = 0; m < ring; ++m) sum += own[*way++];
            at = (*own)[axis_[n]];
            return normal_[vertex_[n]] * (share * sum - *own);
        };
        std::size_t n = run.begin;
        for (; n + 4 <= run.end; n += 4) {
            std::array<float, 4> at;
            const Lanes a = look(n, at[0]), b = look(n + 1, at[1]), c = look(n + 2, at[2]), d = look(n + 3, at[3]);
            const Lanes here{at[0], at[1], at[2], at[3]};
            const auto row = [&](std::size_t lane) { return Lanes{a[lane], b[lane], c[lane], d[lane]}; };
            const Lanes moved = kept(here, here + factor * (row(0) + row(1) + row(2)));
            for (std::size_t m = 0; m < 4; ++m) to[vertex_[n + m]][axis_[n + m]] = moved[m];
        }
        for (; n < run.end; ++n) {
            float at;
            const Lanes product = look(n, at);
            to[vertex_[n]][axis_[n]] = kept(at, at + factor * (product[0] + product[1] + product[2]));
        }
    }

    std::span<const std::int32_t> triangles_;
    std::vector<Share> shares_;
    std::vector<std::uint32_t> ends_;  // of open rings: shape.hpp
    Array<std::uint32_t> place_;       // of each vertex: where its ring begins, until that is filled
    std::vector<std::uint32_t> vertex_;
    std::vector<std::uint8_t> axis_;
    std::vector<Run> runs_;
    std::vector<std::size_t> blocks_;  // where each block's runs begin
    std::size_t ring_size_ = 0;
    Array<Way> ring_;      // from a vertex to the next corner of each triangle around it
    Array<Lanes> normal_;  // of every vertex: by its own component along the axis, which is at least kSteepest
};

}  // namespace isocore::labels
