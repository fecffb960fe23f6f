#include "climbing/boxes/block.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace isocore::climbing {

template <int N>
void Block<N>::load(const SignGrid& signs, const Dims& origin) {
    for (std::size_t a = 0; a < 3; ++a)
        cells[a] = static_cast<int>(std::min<std::size_t>(N, signs.dims[a] - 1 - origin[a]));
    const Word in_volume = static_cast<Word>((std::uint64_t{2} << cells[0]) - 1),
               beyond = DikeBits<N>::kSamples & ~in_volume;
    for (int k = 0; k <= N; ++k) {
        for (int j = 0; j <= N; ++j) {
            const SignRow row = signs.row(origin[1] + static_cast<std::size_t>(std::min(j, cells[1])),
                                          origin[2] + static_cast<std::size_t>(std::min(k, cells[2])));
            Word bits = static_cast<Word>(row.from(origin[0])) & in_volume;
            if (bits >> cells[0] & 1) bits |= beyond;
            rows[static_cast<std::size_t>(j)][static_cast<std::size_t>(k)] = bits;
        }
    }
}

template class Block<1>;
template class Block<2>;
template class Block<4>;
template class Block<8>;
template class Block<16>;
template class Block<32>;

}  // namespace isocore::climbing
