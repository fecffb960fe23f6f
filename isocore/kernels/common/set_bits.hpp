// set_bits.hpp - Visits the set bits of several words, one after the other, without a branch for every word: whether
// one has any, and how many, a processor cannot guess.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace isocore {

// A word whose bits are to be visited, and what tells whose it is.
template <class Tag>
struct TaggedWord {
    std::uint64_t bits;
    Tag tag;
};

// Adds words that have bits to a list; a local variable, so that it can live in registers. What it added counts once it
// is gone. There is room for one more than can be added.
template <class Tag>
class WordAdder {
  public:
    explicit WordAdder(TaggedWord<Tag>*& end) : list_end_(end), end_(end) {}
    WordAdder(const WordAdder&) = delete;
    WordAdder& operator=(const WordAdder&) = delete;
    ~WordAdder() { list_end_ = end_; }
    void operator()(std::uint64_t bits, const Tag& tag) {
        *end_ = {bits, tag};
        end_ += bits != 0;
    }

  private:
    TaggedWord<Tag>*& list_end_;
    TaggedWord<Tag>* end_;
};

// Calls visit(tag, bit) for each bit of the words, all of which have some. The one at the end is overwritten.
template <class Tag, class Visit>
void visit_bits(TaggedWord<Tag>* word, TaggedWord<Tag>* end, const Visit& visit) {
    end->bits = 0;  // it will be read
    std::uint64_t left = word->bits;
    while (word != end) {
        visit(word->tag, std::countr_zero(left));
        left &= left - 1;
        word += left == 0;
        left |= word->bits & -static_cast<std::uint64_t>(left == 0);
    }
}

// So many words at most.
template <class Tag, std::size_t kRoom>
class SetBits {
  public:
    SetBits() = default;
    SetBits(const SetBits&) = delete;
    SetBits& operator=(const SetBits&) = delete;

    void add(std::uint64_t bits, const Tag& tag) { WordAdder<Tag>{end_}(bits, tag); }
    bool full() const { return end_ == words_.data() + kRoom; }

    // Calls visit(tag, bit) for each of them and forgets them.
    template <class Visit>
    void visit(const Visit& visit) {
        TaggedWord<Tag>* const end = end_;
        end_ = words_.data();
        visit_bits(words_.data(), end, visit);
    }

  private:
    std::array<TaggedWord<Tag>, kRoom + 1> words_;  // those that have bits, and one more to write to
    TaggedWord<Tag>* end_ = words_.data();
};

}  // namespace isocore
