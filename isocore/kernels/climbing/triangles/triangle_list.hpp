// triangle_list.hpp - Triangles that are written one after the other, as the numbers of their vertices.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "common/array.hpp"

namespace isocore::climbing {

class TriangleList {
  public:
    // Where so many more can be written, at most. They count once they end somewhere.
    std::int32_t* room_for(std::size_t triangles) {
        if (room_.size() < size_ + 3 * triangles) room_.resize(2 * (size_ + 3 * triangles));
        return room_.data() + size_;
    }
    void end_at(const std::int32_t* end) { size_ = static_cast<std::size_t>(end - room_.data()); }

    std::span<const std::int32_t> vertices() const { return {room_.data(), size_}; }
    std::size_t size() const { return size_ / 3; }
    void clear() { size_ = 0; }

  private:
    Array<std::int32_t> room_;
    std::size_t size_ = 0;  // numbers
};

}  // namespace isocore::climbing
