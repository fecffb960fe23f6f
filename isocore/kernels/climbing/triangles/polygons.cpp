#include "climbing/triangles/polygons.hpp"

#include <limits>
#include <stdexcept>

namespace isocore::climbing {

template <std::size_t length>
void Polygons<length>::triangulate(std::size_t count) {
    constexpr float kIllegal = 1e30f;  // larger than any area, and so small that the sum of a few is finite
    std::array<std::array<Floats, length>, length> area;  // [i][j]: twice the least area of part (i, j)'s triangles
    for (std::size_t i = 0; i + 1 < length; ++i) area[i][i + 1] = 0.0f;
    for (std::size_t span = 2; span < length; ++span) {
        for (std::size_t i = 0; i + span < length; ++i) {
            const std::size_t j = i + span;
            const auto from = places(i), along = minus(places(j), from);
            Floats best(std::numeric_limits<float>::infinity()), apex(0.0f);
            for (std::size_t k = i + 1; k < j; ++k) {
                const auto normal = cross(minus(places(k), from), along);
                const Floats tried = area[i][k] + area[k][j] + root(dot(normal, normal));
                apex = choose(tried < best, Floats(static_cast<float>(k)), apex);
                best = least(best, tried);
            }
            apex.store(apex_[i][j].data());
            const bool is_whole = span + 1 == length;
            area[i][j] = is_whole ? best
                                  : choose(have_no_bit_in_common(Floats(faces_[i].data()), Floats(faces_[j].data())),
                                           best, kIllegal);
        }
    }
    const auto found = area[0][length - 1].each();
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
