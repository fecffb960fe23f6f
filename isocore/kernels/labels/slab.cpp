// slab.cpp - One sweep through a slab: mark what is crossed, number it, draw the cells.
#include "labels/slab.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

#include "common/cube.hpp"
#include "common/large_pages.hpp"

namespace isocore::labels {
namespace {

// A mark is looked for eight at a time: this many lie behind the last of a plane, all 0.
constexpr std::size_t kWord = 8;

std::uint64_t word_at(const std::vector<std::uint8_t>& marks, std::size_t at) {
    std::uint64_t word;
    std::memcpy(&word, marks.data() + at, kWord);
    return word;
}

// Which byte of a word that was read from memory holds its lowest set bit.
std::size_t lowest_byte(std::uint64_t word) {
    const int bit = std::endian::native == std::endian::little ? std::countr_zero(word) : std::countl_zero(word);
    return static_cast<std::size_t>(bit) / 8;
}

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

template <class Rank>
Slab<Rank>::Slab(const Dims& dims) : dims_(dims), row_(dims[0]), plane_(dims[0] * dims[1]) {
    // One more row of background, and a word, lie behind every plane, so that looking at the next row needs no
    // question.
    const std::size_t size = plane_ + row_ + kWord;
    for (Plane* plane : {&low_, &high_}) {
        plane->ranks.assign(size, 0);
        plane->marks.assign(size, 0);
    }
    upright_marks_.assign(size, 0);
    numbers_ = large_array<Numbers>(3 * size);
    std::fill(numbers_.begin(), numbers_.end(), Numbers{});
    low_.numbers = numbers_.data();
    high_.numbers = low_.numbers + size;
    upright_numbers_ = high_.numbers + size;
}

// Slabs that follow one another are of much the same size.
template <class Rank>
void Slab<Rank>::make_room() {
    const auto reserve = [](auto& array, std::size_t size) {
        array.reserve(size);
        ask_for_large_pages(array);
    };
    mesh_ = {};
    reserve(mesh_.vertices, 3 * expected_.vertices);
    reserve(mesh_.elements, expected_.vertices);
    reserve(mesh_.triangles, 3 * expected_.triangles);
    reserve(mesh_.sides, 2 * expected_.triangles);
    reserve(mesh_.curves, expected_.curves);
}

template <class Rank>
SlabMesh Slab<Rank>::finished() {
    const auto little_more = [](std::size_t size) { return size + size / 8; };
    expected_ = {little_more(mesh_.elements.size()), little_more(mesh_.sides.size() / 2),
                 little_more(mesh_.curves.size())};
    return std::move(mesh_);
}

template <class Rank>
void Slab<Rank>::survey_plane(Plane& plane) const {
    const Rank *here = plane.ranks.data(), *next = here + row_;
    std::uint8_t* marks = plane.marks.data();
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
    std::uint8_t* marks = upright_marks_.data();
    const std::size_t count = plane_, row = row_;
    for (std::size_t n = 0; n < count; ++n) marks[n] = low[n] != high[n];
    mark_faces(low, low + 1, high, high + 1, count, 1, marks);
    mark_faces(low, low + row, high, high + row, count, 2, marks);
}

template <class Rank>
std::int32_t Slab<Rank>::add_vertex(std::size_t i, std::size_t j, std::size_t k, Element element) {
    const std::size_t number = mesh_.elements.size();
    const std::array<std::size_t, 3> at{i, j, k};
    std::array<float, 3> place;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const float middle = element >> axis & 1 ? 0.5f : 0.0f;
        place[axis] = static_cast<float>(at[axis]) - 1.0f + middle;  // less the layer of background
    }
    mesh_.vertices.insert(mesh_.vertices.end(), place.begin(), place.end());
    mesh_.elements.push_back(element);
    return static_cast<std::int32_t>(number);
}

template <class Rank>
template <class Visit>
void Slab<Rank>::for_each_marked(const std::vector<std::uint8_t>& marks, const Visit& visit) const {
    for (std::size_t j = 0; j < dims_[1]; ++j) {
        const std::size_t begin = j * row_, end = begin + row_;
        for (std::size_t at = begin; at < end;) {
            const std::uint64_t word = word_at(marks, at);
            if (word == 0) {
                at += kWord;
                continue;
            }
            at += lowest_byte(word);
            if (at < end) visit(at, at - begin, j);
            ++at;
        }
    }
}

template <class Rank>
void Slab<Rank>::number_plane(Plane& plane, std::size_t k, bool of_slab_before) {
    constexpr std::array<Element, 3> kElements{1, 2, 3};
    std::int32_t before = 0;
    if (of_slab_before) {
        for_each_marked(plane.marks,
                        [&](std::size_t at, std::size_t, std::size_t) { before -= std::popcount(plane.marks[at]); });
    }
    for_each_marked(plane.marks, [&](std::size_t at, std::size_t i, std::size_t j) {
        for (std::size_t n = 0; n < 3; ++n) {
            if (plane.marks[at] >> n & 1)
                plane.numbers[at][n] = of_slab_before ? before++ : add_vertex(i, j, k, kElements[n]);
        }
    });
}

template <class Rank>
void Slab<Rank>::number_layer(std::size_t k) {
    constexpr std::array<Element, 3> kElements{4, 5, 6};
    for_each_marked(upright_marks_, [&](std::size_t at, std::size_t i, std::size_t j) {
        for (std::size_t n = 0; n < 3; ++n) {
            if (upright_marks_[at] >> n & 1) upright_numbers_[at][n] = add_vertex(i, j, k, kElements[n]);
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
        for (std::size_t at = begin; at < end; at += kWord) {
            const std::uint64_t here = word_at(low_.marks, at) | word_at(high_.marks, at);
            const std::uint64_t next = word_at(low_.marks, at + row_) | word_at(high_.marks, at + row_);
            std::uint64_t word = (here & kAlongBoth) | ((next | word_at(upright_marks_, at)) & kAlongX);
            while (word != 0) {
                const std::size_t byte = lowest_byte(word);
                if (at + byte >= end) break;
                draw_cell(at + byte, at + byte - begin, j, k);
                std::uint8_t bytes[kWord];
                std::memcpy(bytes, &word, kWord);
                bytes[byte] = 0;
                std::memcpy(&word, bytes, kWord);
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
    const auto stays = static_cast<Element>(disks.several_cones ? kCell | kStays : kCell);
    const std::int32_t middle = disks.middle ? add_vertex(i, j, k, stays) : 0;
    write_cell(disks, ranks, at, middle);
}

template <class Rank>
void Slab<Rank>::write_cell(const CellDisks& disks, const CornerRanks& ranks, std::size_t at, std::int32_t middle) {
    std::array<std::int32_t, 19> number;
    const std::array<const Plane*, 2> plane{&low_, &high_};
    for (std::size_t n = 0; n < 4; ++n) {
        const std::size_t low = n & 1, high = n >> 1;
        number[n] = plane[high]->numbers[at + low * row_][0];
        number[4 + n] = plane[high]->numbers[at + low][1];
        number[8 + n] = upright_numbers_[at + low + high * row_][0];
    }
    for (std::size_t side = 0; side < 2 && disks.faces != 0; ++side) {
        number[12 + side] = upright_numbers_[at + side][2];
        number[14 + side] = upright_numbers_[at + side * row_][1];
        number[16 + side] = plane[side]->numbers[at][2];
    }
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
