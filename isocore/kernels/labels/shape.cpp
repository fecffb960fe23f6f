#include "labels/shape.hpp"

#include <algorithm>

#include "common/parallel.hpp"

namespace isocore::labels {

std::vector<std::uint32_t> find_ends(const Shape& shape) {
    if (!shape.may_be_open) return {};
    // Around an open ring, sums of what comes first and of what comes last differ by its two ends.
    std::vector<std::int64_t> difference(shape.elements.size(), 0);
    const auto for_each_corner = [&](const auto& visit) {
        for (std::size_t t = 0; t < shape.triangles.size(); t += 3) {
            for (std::size_t n = 0; n < 3; ++n) {
                visit(static_cast<std::size_t>(shape.triangles[t + n]), shape.triangles[t + (n + 1) % 3],
                      shape.triangles[t + (n + 2) % 3]);
            }
        }
    };
    for_each_corner(
        [&](std::size_t v, std::int32_t next, std::int32_t last) { difference[v] += next - std::int64_t{last}; });
    // What is left of `last` after all that come first are taken away is the end: by exclusive or, in any order.
    std::vector<std::uint32_t> ends(shape.elements.size(), kNone);
    std::vector<std::uint32_t> mixed(shape.elements.size(), 0);
    for_each_corner([&](std::size_t v, std::int32_t next, std::int32_t last) {
        mixed[v] ^= static_cast<std::uint32_t>(next) ^ static_cast<std::uint32_t>(last);
    });
    // mixed is first ^ end, and difference is first - end: the corner that satisfies both is the end.
    for_each_corner([&](std::size_t v, std::int32_t, std::int32_t last) {
        if (difference[v] == 0) return;
        const auto end = static_cast<std::uint32_t>(last), first = mixed[v] ^ end;
        if (std::int64_t{first} - end == difference[v]) ends[v] = end;
    });
    return ends;
}

std::vector<Share> find_shares(const Shape& shape, int threads) {
    const auto count = static_cast<std::size_t>(std::max(threads, 1));
    std::vector<Share> shares(count);
    parallel_for(threads, count, [&](std::size_t n) {
        const std::size_t vertices = shape.elements.size();
        Share share{vertices * n / count, vertices * (n + 1) / count, 0, shape.triangles.size() / 3};
        const auto touches = [&](std::size_t t) {
            const std::int32_t* corners = shape.triangles.data() + 3 * t;
            return share.holds(corners[0]) || share.holds(corners[1]) || share.holds(corners[2]);
        };
        while (share.first < share.last && !touches(share.first)) ++share.first;
        while (share.first < share.last && !touches(share.last - 1)) --share.last;
        shares[n] = share;
    });
    return shares;
}

std::size_t farthest_corners(std::span<const std::int32_t> triangles, int threads) {
    constexpr std::size_t kShare = 1 << 16;
    std::vector<std::int32_t> most((triangles.size() / 3 + kShare - 1) / kShare, 0);
    parallel_for(threads, most.size(), [&](std::size_t share) {
        std::int32_t here = 0;
        const std::size_t end = std::min(triangles.size(), 3 * (share + 1) * kShare);
        for (std::size_t n = 3 * share * kShare; n < end; n += 3) {
            const auto [low, high] = std::minmax({triangles[n], triangles[n + 1], triangles[n + 2]});
            here = std::max(here, high - low);
        }
        most[share] = here;
    });
    return most.empty() ? 0 : static_cast<std::size_t>(*std::max_element(most.begin(), most.end()));
}

}  // namespace isocore::labels
