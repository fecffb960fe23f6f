#include "climbing/boxes/bar_shadow.hpp"

#include <algorithm>

namespace isocore::climbing {

BarShadow::BarShadow(const SignGrid& signs, std::size_t N, std::size_t y, std::size_t z)
    : any_(signs.words + 1, 0), all_(signs.words + 1, ~std::uint64_t{0}) {
    for (std::size_t k = z; k < std::min(z + N + 1, signs.dims[2]); ++k) {
        for (std::size_t j = y; j < std::min(y + N + 1, signs.dims[1]); ++j) {
            const SignRow row = signs.row(j, k);
            for (std::size_t w = 0; w < signs.words; ++w) {
                any_[w] |= row.word(w);
                all_[w] &= row.word(w);
            }
        }
    }
}

}  // namespace isocore::climbing
