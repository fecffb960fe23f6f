// set_bits.hpp - Visits the set bits of several words, one after the other, without a branch for every word: whether one
// has any, and how many, a processor cannot guess.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace isocore {

template <class Tag, std::size_t kRoom>
class SetBits {
    struct Word {
        std::uint64_t bits;
        Tag tag;
    };

  public:
    // Adds words; a local variable, so that it can live in registers. What it added counts once it is gone.
    class Adder {
      public:
        explicit Adder(SetBits& set) : set_(set), end_(set.end_) {}
        Adder(const Adder&) = delete;
        Adder& operator=(const Adder&) = delete;
        ~Adder() { set_.end_ = end_; }
        void operator()(std::uint64_t bits, const Tag& tag) {
            *end_ = {bits, tag};
            end_ += bits != 0;
        }

      private:
        SetBits& set_;
        Word* end_;
    };

    SetBits() = default;
    SetBits(const SetBits&) = delete;
    SetBits& operator=(const SetBits&) = delete;

    void add(std::uint64_t bits, const Tag& tag) { Adder(*this)(bits, tag); }
    bool full() const { return end_ == words_.data() + kRoom; }

    // Calls visit(tag, bit) for each of them and forgets them.
    template <class Visit>
    void visit(const Visit& visit) {
        const Word* word = words_.data();
        const Word* const end = end_;
        end_->bits = 0;  // it will be read
        end_ = words_.data();
        std::uint64_t left = word->bits;
        while (word != end) {
            visit(word->tag, std::countr_zero(left));
            left &= left - 1;
            word += left == 0;
            left |= word->bits & -static_cast<std::uint64_t>(left == 0);
        }
    }

  private:
    std::array<Word, kRoom + 1> words_;  // those that have bits, and one more to write to
    Word* end_ = words_.data();
};

}  // namespace isocore
