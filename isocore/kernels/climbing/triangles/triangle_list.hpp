// triangle_list.hpp - A growing list of triangles, three vertex numbers each. Writing takes two calls, so that nothing
// is checked in between: out = reserve(n), then, having written up to n triangles to it, end_at(behind the last).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "common/array.hpp"

namespace isocore::climbing {

class TriangleList {
  public:
    // Makes room for `triangles` more, at most, and returns where the first of them goes. Earlier pointers are invalid.
    std::int32_t* reserve(std::size_t triangles) {
        if (room_.size() < size_ + 3 * triangles) room_.resize(2 * (size_ + 3 * triangles));
        return room_.data() + size_;
    }
    // Commits what was written since reserve() up to `end`.
    void end_at(const std::int32_t* end) { size_ = static_cast<std::size_t>(end - room_.data()); }

    std::span<const std::int32_t> vertices() const { return {room_.data(), size_}; }
    std::size_t size() const { return size_ / 3; }  // triangles
    void clear() { size_ = 0; }

  private:
    Array<std::int32_t> room_;
    std::size_t size_ = 0;  // vertex numbers
};

}  // namespace isocore::climbing
