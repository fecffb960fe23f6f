#include "climbing/crossings/gatherer.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "climbing/crossings/spotter.hpp"
#include "common/set_bits.hpp"

namespace isocore::climbing {

Gatherer::Gatherer(const SampleReader& samples, const Options& options) : samples_(samples) {
    const Vector<double> stretch = options.in_world ? options.spacing : Vector<double>{1, 1, 1};
    const double unit = *std::max_element(stretch.begin(), stretch.end());
    max_error = options.max_error / unit;
    for (std::size_t a = 0; a < 3; ++a) scale[a] = static_cast<float>(stretch[a] / unit);
}

// Rows with crossed edges are collected until there are enough; then all their bits are visited in one loop, and all
// their crossings found together. Loops row by row would be short, and their ends mispredicted.
void Gatherer::gather(const Site& site, Clouds& clouds, Ligns& ligns) const {
    struct TaggedRow {  // whose bits a word of crossed edges is
        Edge start;
        LignRow ligns;
    };
    constexpr std::size_t kRowsAtOnce = 24, kRoom = 33 * kRowsAtOnce;
    SetBits<TaggedRow, kRowsAtOnce> rows;
    Spotter<kRoom> spotter(samples_);
    ligns.clear();
    std::array<std::uint32_t, kRoom> edges;  // of `ligns`, in the order in which the spotter has them
    const auto add_rows = [&] {
        std::size_t size = 0;
        rows.visit([&](const TaggedRow& row, int i) {
            spotter.add(row.start.further_along_x(i));
            edges[size++] = static_cast<std::uint32_t>(ligns.cross(row.ligns, i));
        });
        spotter.visit(site.origin, scale,
                      [&](const auto& places, const auto& shares, std::size_t start, std::size_t count) {
                          clouds.add(places, count);
                          const auto each = shares.each();
                          for (std::size_t n = 0; n < count; ++n) ligns.shares[edges[start + n]] = each[n];
                      });
    };
    for (const Edge& start : site.crossed_rows()) {
        const int j = start.at(1), k = start.at(2);
        rows.add(site.row(j, k).crossed[start.axis()], {start, Ligns::row(site.samples(), start.axis(), j, k)});
        if (rows.full()) add_rows();
    }
    add_rows();
}

}  // namespace isocore::climbing
