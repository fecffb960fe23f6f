// smooth.cpp - G. Taubin, "A signal processing approach to fair surface design", SIGGRAPH 1995: a step towards the mean
// of the neighbours and a larger one back. A step does not take the mean's direction, in which a vertex of a grid edge
// can hardly move, but goes to where the smoothed surface meets the edge: README.md.
#include "labels/smooth.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "common/large_pages.hpp"
#include "common/parallel.hpp"
#include "labels/curve_vertices.hpp"
#include "labels/sliding.hpp"

namespace isocore::labels {
namespace {

constexpr float kSmoothing = 0.5f, kUndoing = -0.53f;
constexpr int kSamePace = 8;  // steps for which normals are good enough, once the first have smoothed them

// task(begin, end) for a share of all vertices on each thread.
template <class Task>
void share_vertices(int threads, std::size_t vertices, const Task& task) {
    const auto shares = static_cast<std::size_t>(std::max(threads, 1));
    const auto start = [&](std::size_t share) { return vertices * share / shares; };
    parallel_for(threads, shares, [&](std::size_t n) { task(start(n), start(n + 1)); });
}

// A mesh without its places.
struct Shape {
    std::span<const Element> elements;
    std::span<const std::int32_t> triangles;
    bool may_be_open;
};

// Of an open ring of neighbours its last, which no triangle names first; of a closed one kNone. For every vertex, or
// for none if all rings are closed.
constexpr std::uint32_t kNone = 0xFFFFFFFF;
std::vector<std::uint32_t> find_ends(const Shape& shape) {
    if (!shape.may_be_open) return {};
    // Around an open ring, sums of what comes first and of what comes last differ by its two ends.
    std::vector<std::int64_t> difference(shape.elements.size(), 0);
    const auto for_each_corner = [&](const auto& visit) {
        for (std::size_t t = 0; t < shape.triangles.size(); t += 3) {
            for (std::size_t n = 0; n < 3; ++n) {
                visit(static_cast<std::size_t>(shape.triangles[t + n]), shape.triangles[t + (n + 1) % 3],
                      shape.triangles[t + (n + 2) % 3]);
            }
        }
    };
    for_each_corner(
        [&](std::size_t v, std::int32_t next, std::int32_t last) { difference[v] += next - std::int64_t{last}; });
    // What is left of `last` after all that come first are taken away is the end: by exclusive or, in any order.
    std::vector<std::uint32_t> ends(shape.elements.size(), kNone);
    std::vector<std::uint32_t> mixed(shape.elements.size(), 0);
    for_each_corner([&](std::size_t v, std::int32_t next, std::int32_t last) {
        mixed[v] ^= static_cast<std::uint32_t>(next) ^ static_cast<std::uint32_t>(last);
    });
    // mixed is first ^ end, and difference is first - end: the corner that satisfies both is the end.
    for_each_corner([&](std::size_t v, std::int32_t, std::int32_t last) {
        if (difference[v] == 0) return;
        const auto end = static_cast<std::uint32_t>(last), first = mixed[v] ^ end;
        if (std::int64_t{first} - end == difference[v]) ends[v] = end;
    });
    return ends;
}

// The vertices of grid edges, which slide along them, with their rings of neighbours. They are sorted by the size of
// their ring, block by block, so that loops over a ring have one length many times over.
class EdgeVertices {
  public:
    EdgeVertices(const Shape& shape, int threads) : triangles_(shape.triangles) {
        const std::vector<std::uint32_t> ends = find_ends(shape);
        std::vector<std::uint8_t> sizes(shape.elements.size(), 0);
        for (const std::int32_t corner : shape.triangles) ++sizes[static_cast<std::size_t>(corner)];
        for (std::size_t v = 0; v < ends.size(); ++v)
            sizes[v] = static_cast<std::uint8_t>(sizes[v] + (ends[v] != kNone));
        fill(order(shape, sizes), ends, threads);
    }

    std::size_t blocks() const { return blocks_.size() - 1; }

    // Each thread looks at all triangles for its share of the vertices. A vertex' sum has one order, whoever adds it
    // up.
    void renew_normals(const Places& from, int threads) {
        share_vertices(threads, from.size(), [&](std::size_t begin, std::size_t end) { sum_areas(from, begin, end); });
    }

    // Moves those of a block by one step, from their places in `from` to those in `to`.
    void step(std::size_t block, const Places& from, Places& to, float factor, bool new_normals) {
        // Nearly all rings have three to eight neighbours: loops of a length that the compiler knows.
        using Self = EdgeVertices;
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

    // Returns where the ring of each vertex begins, or kNone.
    std::vector<std::uint32_t> order(const Shape& mesh, const std::vector<std::uint8_t>& sizes) {
        std::size_t first = 0;
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
        for (const std::uint32_t v : vertex_) axis_.push_back(static_cast<std::uint8_t>(mesh.elements[v] / 2));
        normal_ = large_array<Lanes>(mesh.elements.size());
        ring_ = large_array<std::uint32_t>(first);
        std::vector<std::uint32_t> place(mesh.elements.size(), kNone);
        for (const Run& run : runs_) {
            for (std::size_t n = run.begin; n < run.end; ++n) {
                place[vertex_[n]] = static_cast<std::uint32_t>(run.first + (n - run.begin) * run.ring);
            }
        }
        return place;
    }

    // Each triangle at a vertex gives it the two others; as a ring closes, each neighbour comes first exactly once.
    void fill(std::vector<std::uint32_t> place, const std::vector<std::uint32_t>& ends, int threads) {
        share_vertices(threads, place.size(), [&](std::size_t begin, std::size_t end) {
            for (std::size_t t = 0; t < triangles_.size(); t += 3) {
                for (std::size_t n = 0; n < 3; ++n) {
                    const auto v = static_cast<std::size_t>(triangles_[t + n]);
                    if (v - begin >= end - begin || place[v] == kNone) continue;
                    ring_[place[v]++] = static_cast<std::uint32_t>(triangles_[t + (n + 1) % 3]);
                }
            }
            for (std::size_t v = begin; v < end && !ends.empty(); ++v) {
                if (place[v] != kNone && ends[v] != kNone) ring_[place[v]] = ends[v];
            }
        });
    }

    // Twice the area vector of all triangles at a vertex, for the vertices begin to end - 1.
    void sum_areas(const Places& from, std::size_t begin, std::size_t end) {
        std::fill(normal_.begin() + static_cast<std::ptrdiff_t>(begin),
                  normal_.begin() + static_cast<std::ptrdiff_t>(end), Lanes{});
        const std::size_t count = end - begin;
        for (std::size_t t = 0; t < triangles_.size(); t += 3) {
            const auto corner = [&](std::size_t n) { return static_cast<std::size_t>(triangles_[t + n]); };
            const std::array<std::size_t, 3> corners{corner(0), corner(1), corner(2)};
            const auto is_here = [&](std::size_t v) { return v - begin < count; };
            if (!is_here(corners[0]) && !is_here(corners[1]) && !is_here(corners[2])) continue;
            const Lanes& first = from[corners[0]];
            const Lanes area = cross(from[corners[1]] - first, from[corners[2]] - first);
            for (const std::size_t v : corners) {
                if (is_here(v)) normal_[v] += area;
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
        const std::uint32_t* neighbour = ring_.data() + run.first;
        for (std::size_t n = run.begin; n < run.end; ++n, neighbour += ring) {
            Lanes sum{};
            for (std::size_t m = 0; m < ring; ++m) sum += from[neighbour[m]];
            const Lanes& own = from[vertex_[n]];
            const float at = own[axis_[n]];
            to[vertex_[n]][axis_[n]] = kept(at, at + factor * dot(normal_[vertex_[n]], share * sum - own));
        }
    }

    std::span<const std::int32_t> triangles_;
    std::vector<std::uint32_t> vertex_;
    std::vector<std::uint8_t> axis_;
    std::vector<Run> runs_;
    std::vector<std::size_t> blocks_;  // where each block's runs begin
    Array<std::uint32_t> ring_;        // the next corner of each triangle around a vertex
    Array<Lanes> normal_;  // of every vertex: by its own component along the axis, which is at least kSteepest
};

template <class Coordinate>
Places places_of(const Coordinate* vertices, std::size_t count, int threads) {
    Places places = large_array<Lanes>(count);
    share_vertices(threads, count, [&](std::size_t begin, std::size_t end) {
        for (std::size_t n = begin; n < end; ++n) {
            const auto at = [&](std::size_t axis) { return static_cast<float>(vertices[3 * n + axis]); };
            places[n] = Lanes{at(0), at(1), at(2), 0};
        }
    });
    return places;
}

// Only what has moved is written back: other coordinates keep all their digits.
template <class Coordinate>
void write_back(const Places& places, std::span<const Element> elements, Coordinate* vertices, int threads) {
    share_vertices(threads, places.size(), [&](std::size_t begin, std::size_t end) {
        for (std::size_t n = begin; n < end; ++n) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                if (elements[n] >> axis & 1) vertices[3 * n + axis] = static_cast<Coordinate>(places[n][axis]);
            }
        }
    });
}

// Moves `from` by so many rounds.
void run(const Shape& shape, CurveVertices curves, int rounds, int threads, Places& from) {
    Places to = large_array<Lanes>(from.size());
    share_vertices(threads, from.size(), [&](std::size_t begin, std::size_t end) {
        std::copy_n(from.data() + begin, end - begin, to.data() + begin);
    });
    EdgeVertices edges(shape, threads);
    for (int step = 0; step < rounds; ++step) {
        const float factor = step % 2 == 0 ? kSmoothing : kUndoing;
        const bool anew = step == 0 || step % kSamePace == kSamePace / 2;
        if (anew) edges.renew_normals(from, threads);
        parallel_for(threads, edges.blocks(), [&](std::size_t block) {
            edges.step(block, from, to, factor, anew);
            curves.step(block, from, to, factor, anew);
        });
        std::swap(from, to);
    }
}

}  // namespace

void smooth(LabelMesh& mesh, int rounds, int threads) {
    if (rounds <= 0) return;
    Places places = places_of(mesh.vertices.data(), mesh.elements.size(), threads);
    run({mesh.elements, mesh.triangles, false}, CurveVertices(mesh), rounds, threads, places);
    write_back(places, mesh.elements, mesh.vertices.data(), threads);
}

template <class Coordinate>
void smooth(Coordinate* vertices, std::size_t vertex_count, const std::int32_t* triangles, std::size_t triangle_count,
            int rounds, int threads) {
    if (rounds <= 0) return;
    std::vector<Element> elements(vertex_count, 0);
    for (std::size_t n = 0; n < 3 * vertex_count; ++n) {
        const bool inside = vertices[n] != std::floor(vertices[n]);
        elements[n / 3] = static_cast<Element>(elements[n / 3] | (inside ? 1u << n % 3 : 0u));
    }
    Places places = places_of(vertices, vertex_count, threads);
    run({elements, {triangles, 3 * triangle_count}, true}, CurveVertices({}), rounds, threads, places);
    write_back(places, elements, vertices, threads);
}

template void smooth(float*, std::size_t, const std::int32_t*, std::size_t, int, int);
template void smooth(double*, std::size_t, const std::int32_t*, std::size_t, int, int);

}  // namespace isocore::labels
