// gatherer.hpp - What the error bound needs to know of a block: where its crossings are, as one cloud of points, and
// lign by lign.
#pragma once

#include "climbing/crossings/cloud.hpp"
#include "climbing/crossings/ligns.hpp"
#include "climbing/crossings/site.hpp"
#include "climbing/types.hpp"
#include "common/vectors.hpp"
#include "samples/sample_reader.hpp"

namespace isocore::climbing {

// Lengths are in units of the longest side of a voxel, in voxels or in the world as the options ask: in metres the
// squares of small voxels would underflow.
class Gatherer {
  public:
    Gatherer(const SampleReader& samples, const Options& options);

    // Adds all crossings of the closed block that the site is loaded with to the cloud that `clouds` has begun, and
    // notes them in `ligns`, which it clears first.
    void gather(const Site& site, Clouds& clouds, Ligns& ligns) const;

    double max_error;  // in that unit
    Spot scale;        // from samples to that unit, along each axis

  private:
    const SampleReader& samples_;
};

}  // namespace isocore::climbing
