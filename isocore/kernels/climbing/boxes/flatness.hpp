// flatness.hpp - May a box be one piece with an error of at most max_error? All crossings in it must lie in a slab no
// thicker than that, and those on a face no further from the chord of the face's iso-line. The paper has no such test:
// its boxes are as large as simplicity allows. What this test lets through is measured afterwards all the same.
#pragma once

#include <array>

#include "climbing/crossings/cloud.hpp"
#include "common/vectors.hpp"

namespace isocore::climbing {

// All lengths are in the unit of the cloud (gatherer.hpp).
class Flatness {
  public:
    // The crossings on a box's edges, in the order of its Rim (rims.hpp), one lane each: where each is along its edge's
    // axis. Lanes past the rim's length repeat the first crossing.
    using Ring = std::array<float, kLanes>;

    explicit Flatness(double max_error) : max_error_(kMargin * static_cast<float>(max_error)) {}

    // Is a disk box flat enough? The cloud `around` holds all crossings in the closed box, and may hold others; `signs`
    // are those of the box's eight corners.
    bool operator()(const Cloud& around, const Extent& box, unsigned signs, const Ring& ring) const;

  private:
    // A little less than the bound: rounding errors then seldom make a box that passes here break the bound when it is
    // measured, and be halved late.
    static constexpr float kMargin = 1 - 1.0f / 65536;

    bool in_slab(const Cloud& around, const Extent& box, const Vector<Floats>& corners, const Spot& first,
                 Spot normal) const;
    bool near_chords(const Cloud& around, const Extent& box, const Vector<Floats>& from, const Vector<Floats>& to,
                     unsigned signs) const;

    float max_error_;
};

}  // namespace isocore::climbing
