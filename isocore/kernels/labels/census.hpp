// census.hpp - Which labels a volume holds, and how many samples each.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace isocore::labels {

struct Census {
    std::vector<double> values;         // ascending
    std::vector<std::uint64_t> counts;  // samples of each
    std::uint64_t not_a_number = 0;     // NaN samples, which are no label
    bool too_many = false;              // more than `most` values: the others were not counted
    double not_whole = 0;  // the first value that is not a whole number (or is infinite); 0 if there is none
};

// samples: any order, one of the eight sample types. Stops at the first value that is not whole, and after `most`
// values.
template <class Sample>
Census take_census(const Sample* samples, std::size_t count, std::size_t most);

}  // namespace isocore::labels
