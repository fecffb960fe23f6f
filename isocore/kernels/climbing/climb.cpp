// Follows T. Poston, T.-T. Wong, P.-A. Heng, "Multiresolution Isosurface Extraction with Adaptive Skeleton Climbing",
// Computer Graphics Forum 17(3), 1998 (Eurographics '98). README.md in this folder says where we depart and why.
#include "climbing/climb.hpp"

#include <algorithm>
#include <stdexcept>

#include "climbing/extraction.hpp"
#include "samples/sample_reader.hpp"
#include "samples/sample_types.hpp"
#include "samples/signs.hpp"

namespace isocore::climbing {

template <class Sample, class Coordinate>
Mesh<Coordinate> climb(GridView<Sample> samples, const Options& options, const Sample* ranges,
                       const Slopes<Coordinate>& slopes) {
    if (*std::min_element(samples.dims.begin(), samples.dims.end()) < 2) {
        throw std::invalid_argument("climbing needs two samples per axis");
    }
    const SignGrid signs = classify(samples, options.isovalue, options.below, options.capped, options.threads, ranges);
    const SamplesOf<Sample> reader(samples, signs, options.isovalue);

    Extraction<Coordinate> extraction(reader, signs, options, slopes);
    extraction.partition();
    extraction.number_and_place_vertices();
    extraction.draw();
    while (extraction.split()) {}
    return extraction.take();
}

#define ISOCORE_INSTANTIATE(Sample)                                                                    \
    template Mesh<float> climb(GridView<Sample>, const Options&, const Sample*, const Slopes<float>&); \
    template Mesh<double> climb(GridView<Sample>, const Options&, const Sample*, const Slopes<double>&);
ISOCORE_FOR_EACH_SAMPLE_TYPE(ISOCORE_INSTANTIATE)
#undef ISOCORE_INSTANTIATE

}  // namespace isocore::climbing
