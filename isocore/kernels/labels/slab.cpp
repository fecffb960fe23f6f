// slab.cpp - One sweep through a slab: mark what is crossed, number it, draw the cells.
#include "labels/slab.hpp"

#include <algorithm>
#include <bit>

#include "common/cube.hpp"
#include "common/large_pages.hpp"

namespace isocore::labels {
namespace {

// Marks the squares that four rows of ranks bound, a and b along one line, c and d along the next: does what they show
// have a vertex in the middle? Plain loops over bytes, for the compiler to vectorise.
template <class Rank>
void mark_faces(const Rank* a, const Rank* b, const Rank* c, const Rank* d, std::size_t count, unsigned bit,
                std::uint8_t* marks) {
    for (std::size_t n = 0; n < count; ++n) {
        const std::uint8_t low = a[n] != b[n], right = b[n] != d[n], high = d[n] != c[n], left = c[n] != a[n];
        const std::uint8_t apart = (a[n] != d[n]) & (b[n] != c[n]);
        const auto crossings = static_cast<std::uint8_t>(low + right + high + left);
        const auto meets = static_cast<std::uint8_t>((crossings == 3) | ((crossings == 4) & apart));
        marks[n] = static_cast<std::uint8_t>(marks[n] | meets << bit);
    }
}

}  // namespace

DiskCache::DiskCache() {
    for (unsigned higher = 0; higher < 256; ++higher) {
        CornerRanks ranks;
        for (unsigned n = 0; n < 8; ++n) ranks[n] = higher >> n & 1;
        CellDisks disks = derive_disks(ranks);
        for (CellTriangle& triangle : disks.triangles) {
            if (ranks[triangle.ahead] == 0) continue;
            std::swap(triangle.places[1], triangle.places[2]);
            std::swap(triangle.behind, triangle.ahead);
        }
        of_two_.push_back(std::move(disks));
    }
}

const CellDisks& DiskCache::of(const CornerRanks& ranks) {
    const std::uint32_t key = disks_key(ranks);
    const auto found = of_more_.find(key);
    return found != of_more_.end() ? found->second : of_more_.emplace(key, derive_disks(ranks)).first->second;
}

// One more row of background, and a word, lie behind every plane, so that looking at the next row needs no question.
template <class Rank>
Slab<Rank>::Slab(const Dims& dims)
    : dims_(dims),
      row_(dims[0]),
      plane_(dims[0] * dims[1]),
      low_{std::vector<Rank>(plane_ + row_ + Marks::kWord, 0), Marks(plane_ + row_)},
      high_(low_),
      upright_(plane_ + row_) {}

// A closed surface has about two triangles for each vertex.
template <class Rank>
void Slab<Rank>::make_room(std::size_t vertices) {
    const auto reserve = [](auto& array, std::size_t size) {
        array.reserve(size);
        ask_for_large_pages(array);
    };
    mesh_ = {};
    reserve(mesh_.vertices, 3 * vertices);
    reserve(mesh_.elements, vertices);
    reserve(mesh_.triangles, 3 * 2 * vertices);
    reserve(mesh_.sides, 2 * 2 * vertices);
}

template <class Rank>
void Slab<Rank>::survey_plane(Plane& plane) const {
    const Rank *here = plane.ranks.data(), *next = here + row_;
    std::uint8_t* const marks = plane.marks.data();
    const std::size_t count = plane_;  // which the compiler cannot know to stay while bytes are written
    for (std::size_t n = 0; n < count; ++n) {
        const std::uint8_t x = here[n] != here[n + 1], y = here[n] != next[n];
        marks[n] = static_cast<std::uint8_t>(x | y << 1);
    }
    mark_faces(here, here + 1, next, next + 1, count, 2, marks);
}

template <class Rank>
void Slab<Rank>::survey_layer() {
    const Rank *low = low_.ranks.data(), *high = high_.ranks.data();
    std::uint8_t* const marks = upright_.data();
    const std::size_t count = plane_, row = row_;
    for (std::size_t n = 0; n < count; ++n) marks[n] = low[n] != high[n];
    mark_faces(low, low + 1, high, high + 1, count, 1, marks);
    mark_faces(low, low + row, high, high + row, count, 2, marks);
}

template <class Rank>
void Slab<Rank>::set_vertex(std::size_t number, std::size_t i, std::size_t j, std::size_t k, Element element) {
    const std::array<std::size_t, 3> at{i, j, k};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const float middle = element >> axis & 1 ? 0.5f : 0.0f;
        mesh_.vertices[3 * number + axis] =
            static_cast<float>(at[axis]) - 1.0f + middle;  // less the background's layer
    }
    mesh_.elements[number] = element;
}

template <class Rank>
void Slab<Rank>::add_vertices(Marks& marks, std::size_t k, const std::array<Element, 3>& elements) {
    std::size_t next = mesh_.elements.size(), j = 0, row_end = row_;
    const std::size_t count = next + marks.vertices();
    mesh_.vertices.resize(3 * count);
    mesh_.elements.resize(count);
    marks.number(static_cast<std::int32_t>(next), [&](std::size_t at, unsigned mark) {
        for (; at >= row_end; row_end += row_) ++j;
        for (std::size_t n = 0; n < 3; ++n) {
            if (mark >> n & 1) set_vertex(next++, at + row_ - row_end, j, k, elements[n]);
        }
    });
}

// A cell has anything to draw if its corners are not all alike: if one of seven edges that connect them is crossed.
template <class Rank>
void Slab<Rank>::draw_layer(std::size_t k) {
    const std::size_t before = mesh_.elements.size();
    constexpr std::uint64_t kAlongX = 0x0101010101010101u, kAlongBoth = 0x0303030303030303u;
    for (std::size_t j = 0; j + 1 < dims_[1]; ++j) {
        const std::size_t begin = j * row_, end = begin + row_ - 1;
        for (std::size_t at = begin; at < end; at += Marks::kWord) {
            const std::uint64_t here = low_.marks.word(at) | high_.marks.word(at);
            const std::uint64_t next = low_.marks.word(at + row_) | high_.marks.word(at + row_);
            std::uint64_t left = (here & kAlongBoth) | ((next | upright_.word(at)) & kAlongX);
            left |= left >> 1;
            left &= kAlongX & lowest_bits(8 * std::min(end - at, Marks::kWord));
            for (; left != 0; left &= left - 1) {
                const std::size_t cell = at + static_cast<std::size_t>(std::countr_zero(left)) / 8;
                draw_cell(cell, cell - begin, j, k);
            }
        }
    }
    mesh_.last_middles = mesh_.elements.size() - before;
}

template <class Rank>
void Slab<Rank>::draw_cell(std::size_t at, std::size_t i, std::size_t j, std::size_t k) {
    const Rank *low = low_.ranks.data() + at, *high = high_.ranks.data() + at;
    const CornerRanks ranks{low[0], low[1], low[row_], low[row_ + 1], high[0], high[1], high[row_], high[row_ + 1]};
    unsigned others = 0;
    std::uint32_t other = ranks[0];
    for (unsigned n = 1; n < 8; ++n) {
        const bool differs = ranks[n] != ranks[0];
        others |= static_cast<unsigned>(differs) << n;
        other = differs ? ranks[n] : other;
    }
    bool two = true;
    for (unsigned n = 1; n < 8; ++n) two &= ranks[n] == ranks[0] || ranks[n] == other;
    const CellDisks& disks = two ? cache_.of_two(other > ranks[0] ? others : others ^ 255u) : cache_.of(ranks);
    const std::size_t middle = mesh_.elements.size();
    if (disks.middle) {
        mesh_.vertices.resize(3 * (middle + 1));
        mesh_.elements.resize(middle + 1);
        set_vertex(middle, i, j, k, disks.several_cones ? kCell | kStays : kCell);
    }
    write_cell(disks, ranks, at, static_cast<std::int32_t>(middle));
}

template <class Rank>
void Slab<Rank>::write_cell(const CellDisks& disks, const CornerRanks& ranks, std::size_t at, std::int32_t middle) {
    const std::array plane{low_.marks.numbers(at), high_.marks.numbers(at)};
    const std::array plane_row{low_.marks.numbers(at + row_), high_.marks.numbers(at + row_)};
    const std::array upright{upright_.numbers(at), upright_.numbers(at + row_)};
    std::array<std::int32_t, 19> number;
    for (std::size_t n = 0; n < 2; ++n) {
        number[2 * n] = plane[n].here[0];
        number[2 * n + 1] = plane_row[n].here[0];
        number[4 + 2 * n] = plane[n].here[1];
        number[5 + 2 * n] = plane[n].next[1];
        number[8 + 2 * n] = upright[n].here[0];
        number[9 + 2 * n] = upright[n].next[0];
        number[14 + n] = upright[n].here[1];
        number[16 + n] = plane[n].here[2];
    }
    number[kFirstFace] = upright[0].here[2];
    number[kFirstFace + 1] = upright[0].next[2];
    number[kMiddle] = middle;
    const std::size_t before = mesh_.sides.size() / 2, count = disks.triangles.size();
    mesh_.triangles.resize(3 * (before + count));
    mesh_.sides.resize(2 * (before + count));
    std::int32_t* corners = mesh_.triangles.data() + 3 * before;
    std::uint32_t* sides = mesh_.sides.data() + 2 * before;
    for (const CellTriangle& triangle : disks.triangles) {
        auto [a, b, c] = triangle.places;
        std::uint32_t behind = ranks[triangle.behind], ahead = ranks[triangle.ahead];
        if (behind < ahead) {
            std::swap(behind, ahead);
            std::swap(b, c);
        }
        for (const auto place : {a, b, c}) *corners++ = number[place];
        *sides++ = behind;
        *sides++ = ahead;
    }
    for (unsigned left = disks.faces; left != 0; left &= left - 1) {
        mesh_.curves.push_back(number[kFirstFace + static_cast<std::size_t>(std::countr_zero(left))]);
        mesh_.curves.push_back(middle);
    }
}

template class Slab<std::uint8_t>;
template class Slab<std::uint16_t>;
template class Slab<std::uint32_t>;

}  // namespace isocore::labels
