#include "climbing/triangles/polygons.hpp"

#include <limits>
#include <stdexcept>

#include "climbing/triangles/loop_cost.hpp"

namespace isocore::climbing {

template <std::size_t length>
void Polygons<length>::triangulate(std::size_t count, bool tilted) {
    if (tilted)
        triangulate_all<true>(count);
    else
        triangulate_all<false>(count);
}

template <std::size_t length>
template <bool tilted>
void Polygons<length>::triangulate_all(std::size_t count) {
    constexpr float kIllegal = 1e30f;  // larger than any area, and so small that the sum of a few is finite
    std::array<std::array<Floats, length>, length> cost;  // [i][j]: the least of part (i, j)'s triangles
    for (std::size_t i = 0; i + 1 < length; ++i) cost[i][i + 1] = 0.0f;
    for (std::size_t span = 2; span < length; ++span) {
        for (std::size_t i = 0; i + span < length; ++i) {
            const std::size_t j = i + span;
            const auto from = places(i), along = minus(places(j), from);
            Floats best(std::numeric_limits<float>::infinity()), apex(0.0f);
            for (std::size_t k = i + 1; k < j; ++k) {
                const auto normal = cross(minus(places(k), from), along);
                Floats own;
                if constexpr (tilted)
                    own = tilted_area(normal, falls(i, k, j));
                else
                    own = double_area(normal);
                const Floats tried = cost[i][k] + cost[k][j] + own;
                apex = choose(tried < best, Floats(static_cast<float>(k)), apex);
                best = least(best, tried);
            }
            apex.store(apex_[i][j].data());
            const bool is_whole = span + 1 == length;
            cost[i][j] = is_whole ? best
                                  : choose(have_no_bit_in_common(Floats(faces_[i].data()), Floats(faces_[j].data())),
                                           best, kIllegal);
        }
    }
    const auto found = cost[0][length - 1].each();
    for (std::size_t n = 0; n < count; ++n) {
        if (!(found[n] < kIllegal)) throw std::logic_error("a loop has no legal triangulation");
    }
}

template <std::size_t length>
auto Polygons<length>::triangles(std::size_t n) const -> std::array<Triangle, kTriangles> {
    std::array<Triangle, kTriangles> out;
    std::array<LoopPart, length> parts;
    list_triangles(
        length, [&](std::size_t i, std::size_t j) { return static_cast<std::size_t>(apex_[i][j][n]); }, parts.data(),
        out.data());
    return out;
}

template class Polygons<3>;
template class Polygons<4>;
template class Polygons<5>;
template class Polygons<6>;
template class Polygons<7>;
template class Polygons<8>;

}  // namespace isocore::climbing
