#include "simplification/patch.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <type_traits>
#include <utility>

#include "common/prefetch.hpp"

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

// A sheet's triangles in these cells, each once: who counts how often the reference covers a point counts each once.
template <class Real>
void Patch::find(const Reference<Real>& reference, const Cell& low, const Cell& high, std::uint32_t sheet) {
    found_.clear();
    reference.index().each_run_between(low, high, [&](std::uint32_t first, std::uint32_t end) {
        const std::size_t known = found_.size();
        found_.resize(known + (end - first));
        std::int32_t* const run = found_.data() + known - first;
        for (std::uint32_t entry = first; entry < end; ++entry) run[entry] = reference.index().entry(entry);
        constexpr std::uint32_t kPerLine = 5;  // triangles in a line of memory
        for (std::uint32_t entry = first; entry < end; entry += kPerLine)
            ISOCORE_PREFETCH(reference.corners(run[entry]));
    });
    if (reference.mesh().sheets != nullptr) {  // without branches, which would often be mispredicted
        std::size_t kept = 0;
        for (const std::int32_t triangle : found_) {
            found_[kept] = triangle;
            kept += static_cast<std::size_t>(reference.is_in(triangle, sheet));
        }
        found_.resize(kept);
    }
    if (!reference.index().repeats()) return;
    std::sort(found_.begin(), found_.end());
    found_.erase(std::unique(found_.begin(), found_.end()), found_.end());
}

// Eight at once.
void Patch::gather_rows(const Reference<float>& reference, Rows& rows, const Mesh<float>& mesh,
                        const std::array<float, 3>& origin, const Cell& low, const Cell& high) {
    found_.clear();  // of each run: where it begins, and how many triangles it has
    rows.each_run_between(reference, low, high, [&](std::uint32_t from, std::uint32_t count) {
        found_.push_back(static_cast<std::int32_t>(from));
        found_.push_back(static_cast<std::int32_t>(count));
        const float* const numbers = rows.eight(from / kLanes * kLanes);
        constexpr std::size_t kPerLine = 16;
        for (std::size_t n = 0; n < kLanes * kColumns; n += kPerLine) ISOCORE_PREFETCH(numbers + n);
    });
    Vector<Floats> zero, by;
    for (std::size_t a = 0; a < 3; ++a) {
        zero[a] = Floats(origin[a]);
        by[a] = Floats(mesh.stretch()[a]);
    }
    size_ = 0;
    for (std::size_t n = 0; n < found_.size(); n += 2) {
        auto from = static_cast<std::size_t>(found_[n]);
        const std::size_t count = static_cast<std::size_t>(found_[n + 1]), end = from + count;
        if (size_ + count + 2 * kLanes > room_) make_room(2 * (size_ + count) + 16 * kLanes);
        while (from < end) {
            const std::size_t lane = from % kLanes, taken = std::min(kLanes - lane, end - from);
            const float* const source = rows.eight(from - lane) + lane;
            for (std::size_t c = 0; c < Rows::kBorder; ++c)
                ((Floats(source + c * kLanes) - zero[c % 3]) * by[c % 3]).store(column(c) + size_);
            Floats(source + Rows::kBorder * kLanes).store(column(kBorder) + size_);
            size_ += taken;
            from += taken;
        }
    }
    end();
}

template <class Real>
void Patch::gather(const Reference<Real>& reference, Rows& rows, const Mesh<Real>& mesh,
                   const std::array<Real, 3>& origin, const Box& box, std::uint32_t sheet) {
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
    if constexpr (std::is_same_v<Real, float>) {
        if (rows.cover_all(low, high)) return gather_rows(reference, rows, mesh, origin, low, high);
    }
    find(reference, low, high, sheet);
    for (const std::int32_t triangle : found_) ISOCORE_PREFETCH(reference.place(reference.corners(triangle)[1]));
    size_ = 0;
    if (found_.size() + kLanes > room_) make_room(2 * found_.size() + 16 * kLanes);
    float* to = numbers_.data();
    const std::size_t room = room_;
    for (const std::int32_t triangle : found_) {
        const std::int32_t* const corners = reference.corners(triangle);
        for (std::size_t n = 0; n < 3; ++n) {
            const Real* const at = reference.place(corners[n]);
            for (std::size_t a = 0; a < 3; ++a) {
                if constexpr (std::is_same_v<Real, float>)
                    to[(3 * n + a) * room] = at[a];
                else
                    to[(3 * n + a) * room] = static_cast<float>(at[a] - origin[a]);
            }
        }
        to[kBorder * room] = reference.may_be_at_border(triangle) ? 1.0f : 0.0f;
        ++to;
    }
    size_ = static_cast<std::size_t>(to - numbers_.data());
    // Then eight at once.
    for (std::size_t n = 0; n < kBorder; ++n) {
        const Floats by(mesh.stretch()[n % 3]);
        for (float* at = column(n); at < column(n) + size_; at += kLanes) {
            if constexpr (std::is_same_v<Real, float>)
                ((Floats(at) - Floats(origin[n % 3])) * by).store(at);
            else
                (Floats(at) * by).store(at);
        }
    }
    end();
}

template void Patch::gather(const Reference<float>&, Rows&, const Mesh<float>&, const std::array<float, 3>&, const Box&,
                            std::uint32_t);
template void Patch::gather(const Reference<double>&, Rows&, const Mesh<double>&, const std::array<double, 3>&,
                            const Box&, std::uint32_t);

// Which of eight triangles have boxes that touch this one.
unsigned Patch::touching(std::size_t first, const Box& box) const {
    auto apart = Floats(0.0f) < Floats(0.0f);
    for (std::size_t a = 0; a < 3; ++a) {
        const auto at = [&](std::size_t n) { return Floats(column(3 * n + a) + first); };
        apart = apart | (greatest(at(0), greatest(at(1), at(2))) < Floats(box.low[a])) |
                (Floats(box.high[a]) < least(at(0), least(at(1), at(2))));
    }
    return ~apart.bits();
}

void Patch::select(const Patch& from, const Box& box) {
    const std::size_t count = make_room_for(from);
    for (std::size_t first = 0; first < count; first += kLanes) {
        const unsigned bits = from.touching(first, box) & valid(first, count);
        if (bits == 0) continue;
        for (std::size_t n = 0; n < kColumns; ++n) Floats(from.column(n) + first).pack(bits, column(n) + size_);
        size_ += static_cast<std::size_t>(std::popcount(bits));
    }
    end();
}

void Patch::select(const Patch& from, const Box& box, const Facets::Frame& frame, float margin) {
    const std::size_t count = make_room_for(from);
    const std::array<Vector<Floats>, 3> axes{Vector<Floats>{frame.u[0], frame.u[1], frame.u[2]},
                                             {frame.v[0], frame.v[1], frame.v[2]},
                                             {frame.h[0], frame.h[1], frame.h[2]}};
    const Vector<Floats> origin{frame.origin[0], frame.origin[1], frame.origin[2]};
    const float base = frame.top_u - frame.length;
    const Floats beyond_right(margin * std::sqrt(base * base + frame.top_v * frame.top_v)),
        beyond_left(margin * std::sqrt(frame.top_u * frame.top_u + frame.top_v * frame.top_v));
    const Spot low{std::min(0.0f, frame.top_u) - margin, -margin, -margin};
    const Spot high{std::max(frame.length, frame.top_u) + margin, frame.top_v + margin, margin};
    for (std::size_t first = 0; first < count; first += kLanes) {
        unsigned bits = from.touching(first, box) & valid(first, count);
        if (bits == 0) continue;
        std::array<Vector<Floats>, 3> seen;
        for (std::size_t n = 0; n < 3; ++n) {
            const auto at = minus(from.in_lanes(n, first), origin);
            for (std::size_t a = 0; a < 3; ++a) seen[n][a] = dot(at, axes[a]);
        }
        auto apart = Floats(0.0f) < Floats(0.0f);
        for (std::size_t a = 0; a < 3; ++a) {
            apart = apart | (greatest(seen[0][a], greatest(seen[1][a], seen[2][a])) < Floats(low[a])) |
                    (Floats(high[a]) < least(seen[0][a], least(seen[1][a], seen[2][a])));
        }
        const auto right = [&](std::size_t n) {
            return (seen[n][0] - Floats(frame.length)) * Floats(frame.top_v) - seen[n][1] * Floats(base);
        };
        const auto left = [&](std::size_t n) {
            return seen[n][1] * Floats(frame.top_u) - seen[n][0] * Floats(frame.top_v);
        };
        apart = apart | (beyond_right < least(right(0), least(right(1), right(2)))) |
                (beyond_left < least(left(0), least(left(1), left(2))));
        bits &= ~apart.bits();
        if (bits == 0) continue;
        for (std::size_t n = 0; n < kBorder; ++n) seen[n / 3][n % 3].pack(bits, column(n) + size_);
        Floats(from.column(kBorder) + first).pack(bits, column(kBorder) + size_);
        size_ += static_cast<std::size_t>(std::popcount(bits));
    }
    end();
}

// For as many as another patch has, which may be this one: then those that are kept take the places of others. Returns
// how many there were, and forgets them.
std::size_t Patch::make_room_for(const Patch& from) {
    const std::size_t count = from.size_;
    if (room_ < count + 2 * kLanes) make_room(2 * count + 2 * kLanes);
    size_ = 0;
    return count;
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
