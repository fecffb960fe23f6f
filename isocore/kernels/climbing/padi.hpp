// padi.hpp - A padi is the rectangle that two highrices share, a lign of cells thick on neither side: all its ligns are
// simple, so one iso-line crosses it. Here the iso-lines of a whole box face are walked in one go: within the face of
// a simple disk they form one staircase, and the kept edges it meets on its way are the rims of the padis.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "climbing/high_rice.hpp"
#include "climbing/layout.hpp"
#include "common/cube.hpp"
#include "common/signs.hpp"

namespace isocore::climbing {

// A crossed grid edge on a box: its axis, its lower sample, and the faces of the box it lies on, one bit each.
struct RimEdge {
    int axis;
    std::array<std::int32_t, 3> at;
    unsigned faces;

    bool same_place(const RimEdge& other) const { return axis == other.axis && at == other.at; }
};

inline bool sign_at(const SignGrid& signs, const std::array<std::int32_t, 3>& at) {
    return signs.at(static_cast<std::size_t>(at[0]), static_cast<std::size_t>(at[1]), static_cast<std::size_t>(at[2]));
}

// The eight corner signs of a box, numbered as in cube.hpp.
inline unsigned box_corners(const SignGrid& signs, const HighRice& box) {
    unsigned out = 0;
    for (unsigned c = 0; c < 8; ++c) {
        std::array<std::int32_t, 3> at;
        for (std::size_t a = 0; a < 3; ++a) at[a] = c >> a & 1 ? box.high[a] : box.low[a];
        out |= static_cast<unsigned>(sign_at(signs, at)) << c;
    }
    return out;
}

// The one crossing on a crossed edge of a simple box, by halving.
inline RimEdge box_crossing(const SignGrid& signs, const HighRice& box, int edge) {
    const auto axis = static_cast<std::size_t>(edge / 4);
    const int corner = cube::low_corner(edge);
    RimEdge out{edge / 4, {}, 0};
    for (std::size_t a = 0; a < 3; ++a) out.at[a] = corner >> a & 1 ? box.high[a] : box.low[a];
    const bool first = sign_at(signs, out.at);
    std::int32_t low = box.low[axis], high = box.high[axis];
    while (high - low > 1) {
        out.at[axis] = (low + high) / 2;
        (sign_at(signs, out.at) == first ? low : high) = out.at[axis];
    }
    out.at[axis] = low;
    for (int face = 0; face < 6; ++face) out.faces |= static_cast<unsigned>(cube::edge_on_face(edge, face)) << face;
    return out;
}

class RimWalk {
  public:
    RimWalk(const SignGrid& signs, const Layout& layout) : signs_(signs), layout_(layout) {}

    // The loop of a disk box: every vertex on its surface, in the order that turns its triangles outwards.
    void loop(const HighRice& box, const Rim& rim, std::vector<RimEdge>& out) const {
        out.clear();
        RimEdge from = box_crossing(signs_, box, rim.edges[0]);
        for (unsigned n = 0; n < rim.length; ++n) {
            const RimEdge to = box_crossing(signs_, box, rim.edges[(n + 1) % rim.length]);
            out.push_back(from);
            walk(box, rim.faces[n], from, to, out);
            from = to;
        }
    }

  private:
    bool kept(const RimEdge& edge) const {
        return layout_.is_kept(edge.axis, static_cast<std::size_t>(edge.at[0]), static_cast<std::size_t>(edge.at[1]),
                               static_cast<std::size_t>(edge.at[2]));
    }

    // Adds the kept edges strictly between two edges on the rim of a face.
    void walk(const HighRice& box, int face, const RimEdge& from, const RimEdge& to, std::vector<RimEdge>& out) const {
        const auto across = cube::other_axes(face / 2);
        RimEdge here{from.axis, from.at, 1u << face};
        int step = 0;  // along the other axis of the face
        while (true) {
            const auto u = static_cast<std::size_t>(here.axis), v = static_cast<std::size_t>(across[0] + across[1] - here.axis);
            if (step == 0) step = here.at[v] == box.low[v] ? 1 : -1;
            const bool first = sign_at(signs_, here.at);
            auto far = here.at;
            far[v] += step;
            const bool far_first = sign_at(signs_, far);
            ++far[u];
            const bool far_second = sign_at(signs_, far);
            if (far_first != far_second) {
                here.at[v] += step;
            } else {
                if (step < 0) --here.at[v];
                step = far_first == first ? 1 : -1;
                if (step > 0) ++here.at[u];
                here.axis = static_cast<int>(v);
            }
            if (here.same_place(to)) return;
            if (kept(here)) out.push_back(here);
        }
    }

    const SignGrid& signs_;
    const Layout& layout_;
};

}  // namespace isocore::climbing
