#include "simplification/patch.hpp"

#include <algorithm>
#include <bit>

namespace isocore::simplification {

Box Box::around(const std::array<Spot, 3>& triangle, float margin) {
    Box out;
    for (std::size_t a = 0; a < 3; ++a) {
        out.low[a] = std::min({triangle[0][a], triangle[1][a], triangle[2][a]}) - margin;
        out.high[a] = std::max({triangle[0][a], triangle[1][a], triangle[2][a]}) + margin;
    }
    return out;
}

void Box::add(const Box& other) {
    for (std::size_t a = 0; a < 3; ++a) {
        low[a] = std::min(low[a], other.low[a]);
        high[a] = std::max(high[a], other.high[a]);
    }
}

template <class Real>
void Patch::gather(const Reference<Real>& reference, const Mesh<Real>& mesh, const std::array<Real, 3>& origin,
                   const Box& box) {
    const Cells& cells = reference.cells();
    Cell low, high;
    for (std::size_t a = 0; a < 3; ++a) {
        const auto cell = [&](float at) {
            const double place = static_cast<double>(origin[a]) + static_cast<double>(at / mesh.stretch()[a]);
            return cells.clamped(cells.in_cells(place, a), a);
        };
        low[a] = cell(box.low[a]);
        high[a] = cell(box.high[a]);
    }
    size_ = 0;
    reference.each_between(low, high, [&](std::int32_t triangle) {
        if (size_ + kLanes >= columns_[0].size()) make_room(2 * size_ + 16 * kLanes);
        for (std::size_t n = 0; n < 3; ++n) {
            const Spot at = mesh.relative(reference.corner(triangle, n), origin);
            for (std::size_t a = 0; a < 3; ++a) columns_[3 * n + a][size_] = at[a];
        }
        columns_[kBorder][size_] = reference.may_be_at_border(triangle) ? 1.0f : 0.0f;
        ++size_;
    });
    end();
}

template void Patch::gather(const Reference<float>&, const Mesh<float>&, const std::array<float, 3>&, const Box&);
template void Patch::gather(const Reference<double>&, const Mesh<double>&, const std::array<double, 3>&, const Box&);

void Patch::select(const Patch& from, const Box& box) {
    size_ = 0;
    if (columns_[0].size() < from.size_ + 2 * kLanes) make_room(2 * from.size_ + 2 * kLanes);
    for (std::size_t first = 0; first < from.size_; first += kLanes) {
        auto apart = Floats(0.0f) < Floats(0.0f);
        for (std::size_t a = 0; a < 3; ++a) {
            const auto at = [&](std::size_t n) { return Floats(from.columns_[3 * n + a].data() + first); };
            apart = apart | (greatest(at(0), greatest(at(1), at(2))) < Floats(box.low[a])) |
                    (Floats(box.high[a]) < least(at(0), least(at(1), at(2))));
        }
        for (unsigned bits = ~apart.bits() & 255; bits != 0; bits &= bits - 1) {
            const std::size_t n = first + static_cast<std::size_t>(std::countr_zero(bits));
            for (std::size_t column = 0; column < kColumns; ++column)
                columns_[column][size_] = from.columns_[column][n];
            ++size_;
        }
    }
    end();
}

void Patch::make_room(std::size_t size) {
    for (auto& column : columns_) column.resize(size);
}

void Patch::end() {
    constexpr float kFar = 1e9f;
    if (columns_[0].size() < size_ + kLanes) make_room(size_ + kLanes);
    for (auto& column : columns_) Floats(kFar).store(column.data() + size_);
}

}  // namespace isocore::simplification
