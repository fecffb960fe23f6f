// crossings.hpp - Would the faces of a star cut another triangle of the mesh, or each other? Exact: floats only say
// which pairs are clearly apart.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "common/lanes.hpp"
#include "common/meeting.hpp"
#include "simplification/star.hpp"
#include "simplification/triangle_grid.hpp"

namespace isocore::simplification {

// A set of numbers, a byte for each that there may be: bits of one word would have to wait for each other. kNone is
// always there.
class NumberSet {
  public:
    // For numbers below `size`. What is in it stays.
    void make_room(std::size_t size) { numbers_.resize(std::max(numbers_.size(), size + 1)); }

    // False if it is there already.
    bool add(std::int32_t number) { return std::exchange(numbers_[index_of(number)].is_new, false); }
    void remove(std::int32_t number) { numbers_[index_of(number)].is_new = true; }

  private:
    struct Number {
        bool is_new = true;
    };

    static std::size_t index_of(std::int32_t number) { return static_cast<std::size_t>(number - kNone); }

    std::vector<Number> numbers_{Number{false}};  // the first is kNone
};

template <class Real>
class Crossings {
  public:
    Crossings(const Mesh<Real>& mesh, const TriangleGrid& grid)
        : mesh_(mesh), grid_(grid), rounding_(mesh.rounding()) {}

    // The grid was filled anew, and perhaps the mesh.
    void start_over() {
        seen_cubes_.make_room(grid_.cubes().count());
        seen_triangles_.make_room(mesh_.triangles.size());
    }

    // Do the faces meet anything that they should not? facets: star.draw()'s. others: stars of the same vertex, in
    // other sheets, which are drawn at the same time: their faces count, their triangles do not.
    bool are_there(const Star& star, const Facets& facets, const std::vector<const Star*>& others);

    // The cubes that face n of the last star touches.
    std::span<const std::int32_t> cubes_of_face(std::size_t face) const {
        return std::span(cubes_).subspan(starts_[face - 1], starts_[face] - starts_[face - 1]);
    }

  private:
    // Triangles that may meet some faces, coordinate by coordinate, so that eight are looked at together.
    struct Candidates {
        static constexpr std::size_t kNumbers = 9, kColumns = 12;

        std::size_t count = 0;
        std::array<std::vector<float>, kColumns>
            columns;  // x, y, z of three corners; then the corners' numbers, as bits

        void make_room(std::size_t room);
        void end();  // so that lanes past the end hold numbers
        Floats in_lanes(std::size_t column, std::size_t first) const { return Floats(columns[column].data() + first); }
        std::array<std::int32_t, 3> numbers(std::size_t triangle) const;
    };
    // Eight of them, and what all faces ask of them.
    struct Eight {
        std::array<Vector<Floats>, 3> at;
        Vector<Floats> low, high;
        std::array<Floats, 3> in_ring;  // corners that are neighbours of the star's centre: their number there, or -1
        Floats reach, blur;             // blur: of distances from the triangles' planes, which are not normalised
        std::array<Floats, Ring::kRoom> least, most;  // how far each neighbour lies from a plane, if it is no corner
    };

    // What rounding may do to the product of a triangle's two sides with the way to a point, at most: `near`, and
    // `far` for each unit of that way.
    template <class Number>
    struct Blur {
        Number near, far;
    };
    template <class Number>
    Blur<Number> blur_of(const Number& one, const Number& other) const;

    void prepare(const Star& star, const Facets& facets);
    void find_blur(const Star& star, std::size_t face);
    void take_faces(const Star& star);
    void find_cubes(const Star& star);
    void find_triangles(const Star& star);
    void take_triangles(const Star& star);
    void look_at(const Star& star, std::size_t first);
    unsigned apart(std::size_t face) const;
    bool meet_faces(const Star& star, bool are_faces);
    Corners3 exact(const std::array<std::int32_t, 3>& numbers) const;

    using PerFace = std::array<float, Ring::kRoom>;
    const Mesh<Real>& mesh_;
    const TriangleGrid& grid_;
    float rounding_;
    NumberSet seen_cubes_, seen_triangles_;
    std::vector<std::int32_t> cubes_, triangles_;
    std::size_t triangle_count_ = 0;  // in triangles_
    Candidates near_, candidates_;
    Eight eight_;
    std::array<std::size_t, Ring::kRoom> starts_{};  // in cubes_, by face
    Vector<PerFace> normal_, low_, high_;            // of each face, from number 1 on
    PerFace near_blur_, far_blur_;                   // nearer to its plane nothing is clearly on one side: these two
    Vector<float> target_{};
    Spot lowest_{}, highest_{};  // of all
    float reach_ = 0;
};

}  // namespace isocore::simplification
