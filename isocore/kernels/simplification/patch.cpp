#include "simplification/patch.hpp"

#include <algorithm>
#include <bit>
#include <utility>

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
                   const Box& box, std::uint32_t sheet) {
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
    reference.each_run_between(low, high, [&](std::uint32_t first, std::uint32_t end) {
        if (size_ + (end - first) + kLanes > room_) make_room(2 * (size_ + (end - first)) + 16 * kLanes);
        float* to = numbers_.data() + size_;
        for (std::uint32_t entry = first; entry < end; ++entry) {
            const std::int32_t triangle = reference.entry(entry);
            if (!reference.is_in(triangle, sheet)) continue;
            for (std::size_t n = 0; n < 3; ++n) {
                const Spot at = mesh.relative(reference.corner(triangle, n), origin);
                for (std::size_t a = 0; a < 3; ++a) to[(3 * n + a) * room_] = at[a];
            }
            to[kBorder * room_] = reference.may_be_at_border(triangle) ? 1.0f : 0.0f;
            ++to;
        }
        size_ = static_cast<std::size_t>(to - numbers_.data());
    });
    end();
}

template void Patch::gather(const Reference<float>&, const Mesh<float>&, const std::array<float, 3>&, const Box&,
                            std::uint32_t);
template void Patch::gather(const Reference<double>&, const Mesh<double>&, const std::array<double, 3>&, const Box&,
                            std::uint32_t);

void Patch::select(const Patch& from, const Box& box) {
    size_ = 0;
    if (room_ < from.size_ + 2 * kLanes) make_room(2 * from.size_ + 2 * kLanes);
    for (std::size_t first = 0; first < from.size_; first += kLanes) {
        auto apart = Floats(0.0f) < Floats(0.0f);
        for (std::size_t a = 0; a < 3; ++a) {
            const auto at = [&](std::size_t n) { return Floats(from.column(3 * n + a) + first); };
            apart = apart | (greatest(at(0), greatest(at(1), at(2))) < Floats(box.low[a])) |
                    (Floats(box.high[a]) < least(at(0), least(at(1), at(2))));
        }
        const unsigned valid = from.size_ - first < kLanes ? (1u << (from.size_ - first)) - 1 : 255u;
        const unsigned bits = ~apart.bits() & valid;
        if (bits == 0) continue;
        for (std::size_t n = 0; n < kColumns; ++n) Floats(from.column(n) + first).pack(bits, column(n) + size_);
        size_ += static_cast<std::size_t>(std::popcount(bits));
    }
    end();
}

// Keeps what there is.
void Patch::make_room(std::size_t room) {
    std::vector<float> numbers(kColumns * room);
    for (std::size_t n = 0; n < kColumns; ++n) std::copy_n(column(n), std::min(size_, room), numbers.data() + n * room);
    numbers_ = std::move(numbers);
    room_ = room;
}

// So that lanes past the end hold numbers.
void Patch::end() {
    constexpr float kFar = 1e9f;
    if (room_ < size_ + kLanes) make_room(size_ + kLanes);
    for (std::size_t n = 0; n < kColumns; ++n) Floats(kFar).store(column(n) + size_);
}

}  // namespace isocore::simplification
