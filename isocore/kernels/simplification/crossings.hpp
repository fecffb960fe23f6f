// crossings.hpp - Would the faces of a star cut another triangle of the mesh, or each other? Exact: floats only say
// which pairs are clearly apart.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/meeting.hpp"
#include "simplification/star.hpp"
#include "simplification/triangle_grid.hpp"

namespace isocore::simplification {

// A set of numbers, a bit for each that there may be.
class NumberSet {
  public:
    explicit NumberSet(std::size_t size) : words_(size / 64 + 1) {}

    // False if it is there already.
    bool add(std::int32_t number) {
        std::uint64_t& word = words_[static_cast<std::size_t>(number) / 64];
        const std::uint64_t bit = std::uint64_t{1} << number % 64;
        const bool is_new = (word & bit) == 0;
        word |= bit;
        return is_new;
    }
    // Takes it out, and perhaps others.
    void forget_near(std::int32_t number) { words_[static_cast<std::size_t>(number) / 64] = 0; }

  private:
    std::vector<std::uint64_t> words_;
};

template <class Real>
class Crossings {
  public:
    Crossings(const Mesh<Real>& mesh, const TriangleGrid& grid)
        : mesh_(mesh), grid_(grid), seen_cubes_(grid.cube_count()), seen_triangles_(mesh.triangles.size()) {}

    // Do the faces meet anything that they should not? facets: star.draw()'s. others: stars of the same vertex, in
    // other sheets, which are drawn at the same time: their faces count, their triangles do not.
    bool are_there(const Star& star, const Facets& facets, const std::vector<const Star*>& others);

    // The cubes that face n of the last star touches.
    const std::vector<std::int32_t>& cubes_of_faces() const { return cubes_; }
    std::size_t first_cube(std::size_t face) const { return starts_[face - 1]; }
    std::size_t end_cube(std::size_t face) const { return starts_[face]; }

  private:
    // A triangle that may meet some faces; corners that are neighbours of the star's centre, by their number there.
    struct Candidate {
        std::array<std::int32_t, 3> numbers;
        std::array<int, 3> in_ring;
        std::array<Spot, 3> at;
    };

    void prepare(const Star& star, const Facets& facets);
    void find_cubes(const Star& star);
    void find_candidates(const Star& star);
    std::optional<Candidate> candidate(const Star& star, const std::array<std::int32_t, 3>& corners) const;
    bool meets_faces_of(const Star& star, const Star& other) const;
    bool meets_a_face(const Star& star, const Candidate& candidate, std::size_t first_face) const;
    Corners3 exact(const std::array<std::int32_t, 3>& numbers) const;

    using PerFace = std::array<float, Ring::kRoom>;
    const Mesh<Real>& mesh_;
    const TriangleGrid& grid_;
    NumberSet seen_cubes_, seen_triangles_;
    std::vector<std::int32_t> cubes_, candidates_;
    std::array<std::size_t, Ring::kRoom> starts_{};  // in cubes_, by face
    Vector<PerFace> normal_, low_, high_;            // of each face, from number 1 on
    Spot lowest_{}, highest_{};                      // of all
    float reach_ = 0;
};

}  // namespace isocore::simplification
