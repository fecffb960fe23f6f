#include "climbing/crossings/rice_edges.hpp"

#include "common/inlined.hpp"

namespace isocore::climbing {

template <int N>
ISOCORE_INLINED void RiceEdges<N>::add(const HighRice& box) {
    const int x0 = box.low[0], x1 = box.high[0], y0 = box.low[1], y1 = box.high[1], z0 = box.low[2], z1 = box.high[2];
    const std::uint64_t along = (std::uint64_t{1} << x1) - (std::uint64_t{1} << x0),
                        ends = std::uint64_t{1} << x0 | std::uint64_t{1} << x1;
    for (const int k : {z0, z1}) {
        for (const int j : {y0, y1}) at(j, k)[0] |= along;
        for (int j = y0; j < y1; ++j) at(j, k)[1] |= ends;
    }
    for (int k = z0; k < z1; ++k) {
        for (const int j : {y0, y1}) at(j, k)[2] |= ends;
    }
}

template <int N>
ISOCORE_INLINED void RiceEdges<N>::add_cells(int j, int k, std::uint64_t cells) {
    const std::uint64_t ends = cells | cells << 1;
    for (const int up : {0, 1}) {
        for (const int right : {0, 1}) at(j + right, k + up)[0] |= cells;
        at(j, k + up)[1] |= ends;
        at(j + up, k)[2] |= ends;
    }
}

template <int N>
void RiceEdges<N>::add(std::span<const HighRice> boxes) {
    for (const HighRice& box : boxes) add(box);
}

template <int N>
void RiceEdges<N>::add_cells(const std::array<std::uint32_t, N * N>& cells) {
    for (int k = 0; k < N; ++k) {
        for (int j = 0; j < N; ++j) {
            if (const std::uint32_t here = cells[static_cast<std::size_t>(j + N * k)]) add_cells(j, k, here);
        }
    }
}

// Rows in which anything is to be kept are listed first, without a branch: whether one is would be mispredicted.
template <int N>
void RiceEdges<N>::keep(const Site& site, Layout& layout) const {
    struct Part {
        std::uint64_t crossed, edges;
        std::size_t first;
    };
    std::array<Part, 3 * (N + 1) * (N + 1) + 1> parts;  // with room for one entry more, which is written only
    Part* end = parts.data();
    for (const Edge& start : site.crossed_rows()) {
        const int j = start.at(1), k = start.at(2);
        const SiteRow& row = site.row(j, k);
        *end = {row.crossed[start.axis()], rows_[index(j, k)][start.axis()], row.first_crossing[start.axis()]};
        end += (end->crossed & end->edges) != 0;
    }
    for (const Part* part = parts.data(); part != end; ++part) layout.keep(part->crossed, part->edges, part->first);
}

template class RiceEdges<1>;
template class RiceEdges<2>;
template class RiceEdges<4>;
template class RiceEdges<8>;
template class RiceEdges<16>;
template class RiceEdges<32>;

}  // namespace isocore::climbing
