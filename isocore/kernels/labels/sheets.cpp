#include "labels/sheets.hpp"

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "labels/solids.hpp"

namespace isocore::labels {
namespace {

// Which sheet a triangle lies in; most lie in that of the triangle before.
void number_triangles(const LabelMesh& mesh, Sheets& sheets) {
    const std::size_t count = sheets.pairs.size() / 2;
    const auto pair_of = [](const Array<std::uint32_t>& sides, std::size_t n) {
        return std::pair{sides[2 * n], sides[2 * n + 1]};
    };
    sheets.of_triangles = NarrowArray(mesh.sides.size() / 2, count);
    sheets.triangles.assign(count, 0);
    std::size_t last = 0;
    for (std::size_t t = 0; t < sheets.of_triangles.size(); ++t) {
        const auto pair = pair_of(mesh.sides, t);
        if (pair_of(sheets.pairs, last) != pair) {
            std::size_t low = 0, high = count;  // the first that is not below
            while (low < high) {
                const std::size_t middle = (low + high) / 2;
                if (pair_of(sheets.pairs, middle) < pair)
                    low = middle + 1;
                else
                    high = middle;
            }
            last = low;
        }
        sheets.of_triangles.set(t, static_cast<std::uint32_t>(last));
        ++sheets.triangles[last];
    }
}

// A vertex where sheets meet counts for each of them.
void count_vertices(const LabelMesh& mesh, Sheets& sheets) {
    constexpr std::uint32_t kNoSheet = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> first(mesh.elements.size(), kNoSheet);
    std::vector<std::pair<std::int32_t, std::uint32_t>> others;
    sheets.vertices.assign(sheets.pairs.size() / 2, 0);
    for (std::size_t n = 0; n < mesh.triangles.size(); ++n) {
        const std::int32_t vertex = mesh.triangles[n];
        std::uint32_t& known = first[static_cast<std::size_t>(vertex)];
        const std::uint32_t sheet = sheets.of_triangles[n / 3];
        if (known == kNoSheet) {
            known = sheet;
            ++sheets.vertices[sheet];
        } else if (known != sheet) {
            others.emplace_back(vertex, sheet);
        }
    }
    std::sort(others.begin(), others.end());
    others.erase(std::unique(others.begin(), others.end()), others.end());
    for (const auto& [vertex, sheet] : others) ++sheets.vertices[sheet];
}

}  // namespace

Sheets take_sheets(LabelMesh& mesh) {
    Sheets sheets;
    sheets.pairs = neighbours(mesh);
    number_triangles(mesh, sheets);
    Array<std::uint32_t>().swap(mesh.sides);  // an empty list assigned would keep the memory
    Array<std::int32_t>().swap(mesh.curves);
    count_vertices(mesh, sheets);
    return sheets;
}

void replace(LabelMesh& mesh, const Sheets& sheets, Array<float> vertices, Array<std::int32_t> triangles,
             const Array<std::int32_t>& kept, const Array<std::int32_t>& left) {
    Array<Element> elements(kept.size());
    std::transform(kept.begin(), kept.end(), elements.begin(),
                   [&](std::int32_t v) { return mesh.elements[static_cast<std::size_t>(v)]; });
    Array<std::uint32_t> sides(2 * left.size());
    for (std::size_t t = 0; t < left.size(); ++t)
        std::copy_n(sheets.pairs.data() + 2 * std::size_t{sheets.of_triangles[static_cast<std::size_t>(left[t])]}, 2,
                    sides.data() + 2 * t);
    mesh = {std::move(vertices), std::move(elements), std::move(triangles), std::move(sides), {}};
}

}  // namespace isocore::labels
