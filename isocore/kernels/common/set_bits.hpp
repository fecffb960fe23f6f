// set_bits.hpp - Visits the set bits of several words in one loop. How many bits a word has is unpredictable, so that a
// loop of its own for every word would cost a branch misprediction for nearly every word.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace isocore {

// A word whose bits are to be visited, and the caller's note of what the word stands for.
template <class Tag>
struct TaggedWord {
    std::uint64_t bits;
    Tag tag;
};

// Appends words to a list, and leaves zeros out without a branch: every word is written, but the end moves on only
// behind one that has bits. Make it a local variable, so that its copy of the end lives in a register; the destructor
// hands that end to the list. The list needs room for one word more than it may hold.
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

// Calls visit(tag, bit) for each set bit of the words from `word` to `end`, none of which may be 0. Writes to *end too.
template <class Tag, class Visit>
void visit_bits(TaggedWord<Tag>* word, TaggedWord<Tag>* end, const Visit& visit) {
    end->bits = 0;  // the loop reads one word further than it visits
    std::uint64_t left = word->bits;
    while (word != end) {
        visit(word->tag, std::countr_zero(left));
        left &= left - 1;
        word += left == 0;
        left |= word->bits & -static_cast<std::uint64_t>(left == 0);
    }
}

// A list of at most kRoom words.
template <class Tag, std::size_t kRoom>
class SetBits {
  public:
    SetBits() = default;
    SetBits(const SetBits&) = delete;
    SetBits& operator=(const SetBits&) = delete;

    void add(std::uint64_t bits, const Tag& tag) { WordAdder<Tag>{end_}(bits, tag); }
    bool empty() const { return end_ == words_.data(); }
    bool full() const { return end_ == words_.data() + kRoom; }

    // Calls visit(tag, bit) for each set bit of the words in the list, and empties the list.
    template <class Visit>
    void visit(const Visit& visit) {
        TaggedWord<Tag>* const end = end_;
        end_ = words_.data();
        visit_bits(words_.data(), end, visit);
    }

  private:
    std::array<TaggedWord<Tag>, kRoom + 1> words_;  // one more than may be held: see WordAdder
    TaggedWord<Tag>* end_ = words_.data();
};

}  // namespace isocore
