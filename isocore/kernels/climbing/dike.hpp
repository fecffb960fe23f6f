// dike.hpp - A dike is a dyadic segment of a lign, named by its label: 1 is the whole lign of N cells, and the halves
// of dike k are 2k and 2k + 1 (section 3 of the paper).
#pragma once

#include <bit>

namespace isocore::climbing {

using Label = unsigned;

template <int N>
struct Dike {
    static_assert(std::has_single_bit(static_cast<unsigned>(N)) && N <= 32);
    static constexpr int kDepth = std::countr_zero(static_cast<unsigned>(N));

    static constexpr int level(Label label) { return std::bit_width(label) - 1; }
    static constexpr int length(Label label) { return N >> level(label); }
    static constexpr int start(Label label) { return static_cast<int>(label << (kDepth - level(label))) - N; }
    static constexpr int end(Label label) { return start(label) + length(label); }
    static constexpr bool is_unit(Label label) { return label >= static_cast<Label>(N); }
};

}  // namespace isocore::climbing
