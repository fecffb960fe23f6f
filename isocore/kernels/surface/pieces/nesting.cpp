// nesting.cpp - Lines through one vertex of each shell, all of them in one sweep over the triangles: a shell is around
// another one where the line leaves it more often than it enters it beyond the vertex, or less often.
#include "surface/pieces/nesting.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "common/parallel.hpp"
#include "common/predicates.hpp"
#include "surface/pieces/lines.hpp"

namespace isocore {
namespace {

constexpr std::size_t kBlock = 16384;  // triangles
constexpr int kRounds = 8;

bool is_inward(const Shell& shell) { return shell.closed && shell.volume < 0; }

// Vertices of shells that are asked about, all of which face the same way; those around them face the other way.
struct Asked {
    bool inward;
    std::vector<std::int32_t> shells;
    std::vector<Point> points;
};

struct Passage {
    std::uint32_t asked;
    std::int32_t shell;
    int way;  // 1: the line leaves the shell beyond the vertex; -1: it enters it

    auto operator<=>(const Passage&) const = default;
};

template <class Real>
Corner3 corners_of(const MeshView<Real>& mesh, std::size_t triangle) {
    const std::int32_t* corners = mesh.triangles + 3 * triangle;
    return {mesh.vertex(corners[0]), mesh.vertex(corners[1]), mesh.vertex(corners[2])};
}

template <class Real>
std::int32_t shell_of(const MeshView<Real>& mesh, const Shells& shells, std::size_t triangle) {
    return shells.of_vertex[static_cast<std::size_t>(mesh.triangles[3 * triangle])];
}

const Shell& at(const Shells& shells, std::int32_t number) { return shells.shells[static_cast<std::size_t>(number)]; }

// What one block of triangles has to say.
struct Sweep {
    std::vector<Passage> passages;
    std::vector<std::uint32_t> touched;  // asked vertices that lie on another shell
};

template <class Real>
Sweep swept(const MeshView<Real>& mesh, const Shells& shells, const Asked& asked, const Lines& lines,
            const std::vector<std::uint8_t>& is_other, std::size_t block) {
    Sweep found;
    const std::size_t end = std::min(mesh.triangle_count, (block + 1) * kBlock);
    for (std::size_t t = block * kBlock; t < end; ++t) {
        const std::int32_t shell = shell_of(mesh, shells, t);
        if (shell < 0 || is_other[static_cast<std::size_t>(shell)] == 0) continue;
        const Corner3 corners = corners_of(mesh, t);
        lines.for_each(corners, [&](std::uint32_t n) {
            const Point& p = asked.points[n];
            if (p == corners[0] || p == corners[1] || p == corners[2]) found.touched.push_back(n);
            const int way = passage(corners, p, 0);
            if (way == 0) return;
            const int side = side_of_plane(corners[0], corners[1], corners[2], p);
            if (side == 0) found.touched.push_back(n);
            if (side * way < 0) found.passages.push_back({n, shell, way});
        });
    }
    return found;
}

template <class Real>
Sweep swept(const MeshView<Real>& mesh, const Shells& shells, const Asked& asked, int threads) {
    const Lines lines(asked.points, 0);
    const std::size_t blocks = (mesh.triangle_count + kBlock - 1) / kBlock;
    std::vector<std::uint8_t> is_other;  // of each shell: may it be around those asked about?
    for (const Shell& shell : shells.shells) is_other.push_back(shell.closed && is_inward(shell) != asked.inward);
    std::vector<Sweep> parts(blocks);
    parallel_for(threads, blocks,
                 [&](std::size_t block) { parts[block] = swept(mesh, shells, asked, lines, is_other, block); });
    Sweep all;
    for (const Sweep& part : parts) {
        all.passages.insert(all.passages.end(), part.passages.begin(), part.passages.end());
        all.touched.insert(all.touched.end(), part.touched.begin(), part.touched.end());
    }
    std::sort(all.passages.begin(), all.passages.end());
    return all;
}

// Sets `around` of the shells that were asked about.
void take_smallest(const Sweep& sweep, const Asked& asked, const Shells& shells, Nesting& nesting) {
    for (const std::int32_t shell : asked.shells) nesting.around[static_cast<std::size_t>(shell)] = -1;
    const std::vector<Passage>& passages = sweep.passages;
    for (std::size_t begin = 0, end = 0; begin < passages.size(); begin = end) {
        const Passage& first = passages[begin];
        int winding = 0;
        for (end = begin;
             end < passages.size() && passages[end].asked == first.asked && passages[end].shell == first.shell; ++end) {
            winding += passages[end].way;
        }
        if (winding == 0) continue;
        std::int32_t& around = nesting.around[static_cast<std::size_t>(asked.shells[first.asked])];
        const double size = std::abs(at(shells, first.shell).volume);
        if (around < 0 || size < std::abs(at(shells, around).volume)) around = first.shell;
    }
}

template <class Real>
Asked first_asked(const MeshView<Real>& mesh, const Shells& shells, bool inward) {
    Asked asked{inward, {}, {}};
    for (std::size_t n = 0; n < shells.shells.size(); ++n) {
        if (is_inward(shells.shells[n]) != inward) continue;
        asked.shells.push_back(static_cast<std::int32_t>(n));
        asked.points.push_back(mesh.vertex(shells.shells[n].first));
    }
    return asked;
}

// The next vertices of the shells whose vertices touched another one.
template <class Real>
Asked asked_again(const MeshView<Real>& mesh, const Shells& shells, const Asked& asked,
                  const std::vector<std::uint32_t>& touched, int round) {
    std::vector<int> left(shells.shells.size(), 0);  // vertices to be passed over, and one
    for (const std::uint32_t n : touched) left[static_cast<std::size_t>(asked.shells[n])] = round + 2;
    Asked next{asked.inward, {}, {}};
    for (std::size_t v = 0; v < mesh.vertex_count; ++v) {
        const std::int32_t shell = shells.of_vertex[v];
        if (shell < 0 || left[static_cast<std::size_t>(shell)] == 0) continue;
        if (--left[static_cast<std::size_t>(shell)] > 0) continue;
        next.shells.push_back(shell);
        next.points.push_back(mesh.vertex(static_cast<std::int32_t>(v)));
    }
    return next;
}

// Of each inward shell that nothing closed is around, the open shell that faces it along an axis, the nearest one.
class Facing {
  public:
    explicit Facing(std::size_t count) : nearest_(count, std::numeric_limits<double>::infinity()), shells_(count, -1) {}

    template <class Real>
    void look(const MeshView<Real>& mesh, const Shells& shells, const Asked& asked, std::size_t axis, int towards) {
        std::fill(nearest_.begin(), nearest_.end(), std::numeric_limits<double>::infinity());
        std::vector<std::int32_t> found(asked.shells.size(), -1);
        const Lines lines(asked.points, axis);
        for (std::size_t t = 0; t < mesh.triangle_count; ++t) {
            const std::int32_t shell = shell_of(mesh, shells, t);
            if (shell < 0 || at(shells, shell).closed) continue;
            const Corner3 corners = corners_of(mesh, t);
            lines.for_each(corners, [&](std::uint32_t n) {
                const int way = passage(corners, asked.points[n], axis);
                const double distance = way == 0 ? -1 : towards * ahead(corners, asked.points[n], axis);
                if (distance <= 0 || distance >= nearest_[n]) return;
                nearest_[n] = distance;
                found[n] = way == towards ? shell : -1;
            });
        }
        for (std::size_t n = 0; n < found.size(); ++n) {
            if (shells_[n] < 0) shells_[n] = found[n];
        }
    }

    const std::vector<std::int32_t>& shells() const { return shells_; }

  private:
    // How far ahead of p along `axis` its line meets the triangle's plane.
    static double ahead(const Corner3& corners, const Point& p, std::size_t axis) {
        const Vec3 normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
        return dot(normal, corners[0] - p) / normal[axis];
    }

    std::vector<double> nearest_;
    std::vector<std::int32_t> shells_;
};

// Gives the bubbles of open shells to them.
template <class Real>
void join_open(const MeshView<Real>& mesh, const Shells& shells, Nesting& nesting) {
    Asked asked{true, {}, {}};
    bool any_open = false;
    for (std::size_t n = 0; n < shells.shells.size(); ++n) {
        const Shell& shell = shells.shells[n];
        any_open = any_open || !shell.closed;
        if (!is_inward(shell) || nesting.around[n] >= 0) continue;
        asked.shells.push_back(static_cast<std::int32_t>(n));
        asked.points.push_back(mesh.vertex(shell.first));
    }
    if (!any_open || asked.shells.empty()) return;
    Facing facing(asked.shells.size());
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for (const int towards : {1, -1}) facing.look(mesh, shells, asked, axis, towards);
    }
    for (std::size_t n = 0; n < asked.shells.size(); ++n) {
        if (facing.shells()[n] >= 0) nesting.piece[static_cast<std::size_t>(asked.shells[n])] = facing.shells()[n];
    }
}

}  // namespace

template <class Real>
Nesting nesting_of(const MeshView<Real>& mesh, const Shells& shells, int threads) {
    const std::size_t count = shells.shells.size();
    Nesting nesting;
    nesting.around.assign(count, -1);
    nesting.piece.resize(count);
    std::iota(nesting.piece.begin(), nesting.piece.end(), 0);
    const auto inward = std::count_if(shells.shells.begin(), shells.shells.end(), is_inward);
    if (inward == 0) return nesting;
    for (const bool way : {true, false}) {
        Asked asked = first_asked(mesh, shells, way);
        for (int round = 0; round < kRounds && !asked.shells.empty(); ++round) {
            const Sweep sweep = swept(mesh, shells, asked, threads);
            take_smallest(sweep, asked, shells, nesting);
            asked = asked_again(mesh, shells, asked, sweep.touched, round);
        }
    }
    for (std::size_t n = 0; n < count; ++n) {
        if (is_inward(shells.shells[n]) && nesting.around[n] >= 0) nesting.piece[n] = nesting.around[n];
    }
    join_open(mesh, shells, nesting);
    return nesting;
}

template Nesting nesting_of(const MeshView<float>&, const Shells&, int);
template Nesting nesting_of(const MeshView<double>&, const Shells&, int);

}  // namespace isocore
