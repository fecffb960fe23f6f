// gatherer.hpp - What the error bound needs to know of a block: where its crossings are.
#pragma once

#include <array>

#include "climbing/crossings/cloud.hpp"
#include "climbing/crossings/ligns.hpp"
#include "climbing/crossings/site.hpp"
#include "climbing/types.hpp"
#include "climbing/vectors.hpp"
#include "samples/sample_reader.hpp"

namespace isocore::climbing {

class Gatherer {
  public:
    // Lengths are in units as long as the longest side of a voxel, as squares of very small numbers would underflow.
    Gatherer(const SampleReader& samples, const Options& options);

    // Adds all crossings of the closed block that the site has loaded, as one cloud, and notes them lign by lign.
    void gather(const Site& site, Clouds& clouds, Ligns& ligns) const;

    double max_error;  // in that unit
    Spot scale;        // from samples to that unit

  private:
    const SampleReader& samples_;
};

}  // namespace isocore::climbing
